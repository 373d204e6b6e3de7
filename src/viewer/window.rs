//! Shows frames in a window, and sends its keys and mouse events.

use super::canvas::Canvas;
use super::frame::Frame;
use super::keys::Key;
use super::options::Options;
use super::playlist::Playlist;
use super::session::{Viewer, exit_flag};
use super::state::Event;
use super::timing::Summary;
use super::window_text;
use crossterm::event::ModifierKeyCode;
use octray_formats::scene::Loaded;
use std::num::NonZeroU32;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::dpi::{LogicalSize, PhysicalSize};
use winit::event::{DeviceEvent, DeviceId, ElementState, MouseButton, MouseScrollDelta, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, OwnedDisplayHandle};
use winit::keyboard::{KeyCode, NamedKey, PhysicalKey};
use winit::window::{CursorGrabMode, Window, WindowId};

/// Initial size of the window relative to the picture, where the screen is large enough.
const INITIAL_SCALE: f64 = 4.0;
/// Interval at which the exit signal is checked.
const POLL_INTERVAL: Duration = Duration::from_millis(100);
/// Largest initial share of the screen's sides.
const MAX_SCREEN_SHARE: f64 = 0.9;

/// The reason why there is no window.
#[derive(Debug, thiserror::Error)]
pub enum WindowError {
    /// No X or Wayland display answers. The text names those that were tried.
    #[error(
        "{0}\n  octray view --terminal shows the scene in a terminal, octray render writes it into a file"
    )]
    NoDisplay(String),
    /// The window cannot be opened or drawn in.
    #[error(
        "the window cannot be drawn in\n  octray view --terminal shows the scene in a terminal, octray render writes it into a file"
    )]
    NoSurface(#[source] Box<dyn std::error::Error + Send + Sync>),
}

struct FrameReady;

/// Opens a window, and returns the figures of the render loop and of the window once it is closed.
///
/// # Errors
/// If no display answers, or the window cannot be drawn in.
pub fn window(options: Options, playlist: Playlist, scene: Loaded) -> Result<Summary, WindowError> {
    let mut builder = EventLoop::with_user_event();
    #[cfg(target_os = "linux")]
    if !has_wayland() {
        winit::platform::x11::EventLoopBuilderExtX11::with_x11(&mut builder);
    }
    let events = builder.build().map_err(|_| no_display())?;
    let context = softbuffer::Context::new(events.owned_display_handle()).map_err(no_surface)?;
    let proxy = events.create_proxy();
    let size = (options.settings)(&scene).resolution;
    let wake = Arc::new(move || {
        // Sending fails only after the event loop has ended.
        let _ = proxy.send_event(FrameReady);
    });
    let viewer = Viewer::start(options, playlist, scene, wake);
    let mut app = App {
        viewer,
        // Nothing sets the flag if the handlers cannot be registered.
        exit: exit_flag().unwrap_or_default(),
        size,
        context,
        surface: None,
        frame: Frame::default(),
        window_size: PhysicalSize::default(),
        title: String::new(),
        mouse_captured: false,
        presented: (0, Duration::ZERO),
        failure: None,
    };
    events.run_app(&mut app).map_err(|_| no_display())?;
    let App { viewer, presented, failure, .. } = app;
    let summary = viewer.finish();
    match failure {
        Some(failure) => Err(failure),
        None => Ok(Summary { presented: Some(presented), ..summary }),
    }
}

/// Tests whether a Wayland compositor answers: the environment may name one that has ended or belongs to
/// another user.
#[cfg(target_os = "linux")]
fn has_wayland() -> bool {
    use std::env::var_os;
    use std::os::unix::fs::FileTypeExt;
    use std::os::unix::net::UnixStream;
    use std::path::Path;
    if let Some(open) = var_os("WAYLAND_SOCKET").filter(|open| !open.is_empty()) {
        // File descriptor of a connection opened by the parent process.
        let open = std::fs::metadata(Path::new("/proc/self/fd").join(open));
        return open.is_ok_and(|open| open.file_type().is_socket());
    }
    let Some(name) = var_os("WAYLAND_DISPLAY").filter(|name| !name.is_empty()) else { return false };
    let folder = var_os("XDG_RUNTIME_DIR").unwrap_or_default();
    UnixStream::connect(Path::new(&folder).join(name)).is_ok()
}

/// Returns an error that names the displays tried. The messages of the window system name only its source
/// files.
fn no_display() -> WindowError {
    let named = ["WAYLAND_SOCKET", "WAYLAND_DISPLAY", "DISPLAY"].into_iter().filter_map(|name| {
        let display = std::env::var(name).ok().filter(|display| !display.is_empty())?;
        Some(format!("{name}={display}"))
    });
    let mut text = "there is no display to open a window on".to_string();
    let named = named.collect::<Vec<_>>().join(" or ");
    if !named.is_empty() {
        text += &format!(": none can be reached at {named}");
    }
    WindowError::NoDisplay(text)
}

fn no_surface(error: impl std::fmt::Display) -> WindowError {
    WindowError::NoSurface(error.to_string().into())
}

type Surface = softbuffer::Surface<OwnedDisplayHandle, Rc<Window>>;

struct App {
    viewer: Viewer,
    exit: Arc<AtomicBool>,
    /// Resolution of the first picture.
    size: [u32; 2],
    context: softbuffer::Context<OwnedDisplayHandle>,
    surface: Option<Surface>,
    frame: Frame,
    /// The window's size at the last event: querying a closed window panics.
    window_size: PhysicalSize<u32>,
    title: String,
    mouse_captured: bool,
    /// See [`Summary::presented`].
    presented: (u64, Duration),
    failure: Option<WindowError>,
}

impl App {
    fn open(&mut self, events: &ActiveEventLoop) -> Result<(), WindowError> {
        let monitor = events.primary_monitor().or_else(|| events.available_monitors().next());
        let [width, height] = self.size.map(f64::from);
        let mut scale = INITIAL_SCALE;
        if let Some(monitor) = &monitor {
            let screen = monitor.size().to_logical::<f64>(monitor.scale_factor());
            if screen.width > 0.0 && screen.height > 0.0 {
                let most = (screen.width / width).min(screen.height / height) * MAX_SCREEN_SHARE;
                scale = scale.min(most);
            }
            if let Some(rate) = monitor.refresh_rate_millihertz() {
                self.viewer.send(Event::Rate(f64::from(rate) / 1e3));
            }
        }
        let size = LogicalSize::new((width * scale).max(160.0), (height * scale).max(90.0));
        let attributes = Window::default_attributes().with_title("octray").with_inner_size(size);
        let window = events.create_window(attributes).map_err(no_surface)?;
        self.window_size = window.inner_size();
        self.surface = Some(Surface::new(&self.context, Rc::new(window)).map_err(no_surface)?);
        Ok(())
    }

    /// Draws the newest frame, or the last one again if there is no newer one.
    fn draw(&mut self) -> Result<(), WindowError> {
        let Some(surface) = &mut self.surface else { return Ok(()) };
        let fresh = self.viewer.swap_newer(&mut self.frame);
        let PhysicalSize { width: across, height: down } = self.window_size;
        let (Some(width), Some(height)) = (NonZeroU32::new(across), NonZeroU32::new(down)) else {
            return Ok(());
        };
        let start = Instant::now();
        surface.resize(width, height).map_err(no_surface)?;
        let mut buffer = surface.buffer_mut().map_err(no_surface)?;
        let canvas = Canvas { pixels: &mut buffer, width: across as usize, height: down as usize };
        window_text::draw(&self.frame, canvas);
        buffer.present().map_err(no_surface)?;
        if fresh {
            self.presented.0 += 1;
            self.presented.1 += start.elapsed();
            if self.title != self.frame.title {
                self.title.clone_from(&self.frame.title);
                surface.window().set_title(&format!("octray · {}", self.title));
            }
        }
        let captured = self.frame.mouse_captured;
        if captured != std::mem::replace(&mut self.mouse_captured, captured) {
            capture_mouse(surface.window(), captured);
        }
        Ok(())
    }
}

fn capture_mouse(window: &Window, captured: bool) {
    let mode = if captured { CursorGrabMode::Locked } else { CursorGrabMode::None };
    if window.set_cursor_grab(mode).is_err() && captured {
        // Systems that cannot lock the pointer confine it to the window. Without either, it still turns the
        // camera.
        let _ = window.set_cursor_grab(CursorGrabMode::Confined);
    }
    window.set_cursor_visible(!captured);
}

impl ApplicationHandler<FrameReady> for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.surface.is_none() {
            self.failure = self.open(events).err();
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        if self.failure.is_some() || self.viewer.is_finished() || self.exit.load(Ordering::Relaxed) {
            return events.exit();
        }
        events.set_control_flow(ControlFlow::WaitUntil(Instant::now() + POLL_INTERVAL));
    }

    fn user_event(&mut self, _: &ActiveEventLoop, _: FrameReady) {
        if let Some(surface) = &self.surface {
            surface.window().request_redraw();
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        match event {
            WindowEvent::CloseRequested | WindowEvent::Destroyed => events.exit(),
            WindowEvent::Resized(size) => self.window_size = size,
            WindowEvent::RedrawRequested => self.failure = self.draw().err(),
            // A synthetic event reports a key that was down when the window got the focus.
            WindowEvent::KeyboardInput { is_synthetic: true, .. } => {}
            WindowEvent::KeyboardInput { event, .. } => {
                if let Some(key) = key_of(event.physical_key, &event.logical_key) {
                    let down = event.state == ElementState::Pressed;
                    self.viewer.send(Event::Key { key, down, repeat: event.repeat });
                }
            }
            WindowEvent::Focused(false) => self.viewer.send(Event::Unfocused),
            WindowEvent::MouseInput { state: ElementState::Pressed, button: MouseButton::Left, .. } => {
                self.viewer.send(Event::Click);
            }
            WindowEvent::MouseWheel { delta, .. } => self.viewer.send(Event::Wheel(match delta {
                MouseScrollDelta::LineDelta(_, lines) => f64::from(lines),
                MouseScrollDelta::PixelDelta(travel) => travel.y / 40.0,
            })),
            WindowEvent::DroppedFile(path) => {
                self.viewer.send(Event::Dropped(path.into_os_string()));
            }
            _ => {}
        }
    }

    fn device_event(&mut self, _: &ActiveEventLoop, _: DeviceId, event: DeviceEvent) {
        if let (DeviceEvent::MouseMotion { delta: (right, down) }, true) = (event, self.mouse_captured) {
            self.viewer.send(Event::Mouse([right, down]));
        }
    }
}

/// Translates a key. Letters for walking follow the physical key, others follow the keyboard layout.
fn key_of(physical: PhysicalKey, logical: &winit::keyboard::Key) -> Option<Key> {
    let letter = match logical {
        winit::keyboard::Key::Character(text) => text.chars().flat_map(char::to_lowercase).next(),
        _ => None,
    };
    let letter = match (physical, letter) {
        (PhysicalKey::Code(KeyCode::KeyW), _) => Some('w'),
        (PhysicalKey::Code(KeyCode::KeyA), _) => Some('a'),
        (PhysicalKey::Code(KeyCode::KeyS), _) => Some('s'),
        (PhysicalKey::Code(KeyCode::KeyD), _) => Some('d'),
        // The positions of A and W on French keyboards.
        (PhysicalKey::Code(KeyCode::KeyQ), Some('a')) => Some('q'),
        (PhysicalKey::Code(KeyCode::KeyZ), Some('w')) => Some('z'),
        _ => letter,
    };
    let named = match logical {
        winit::keyboard::Key::Named(named) if letter.is_none() => named,
        _ => return letter.map(Key::Char),
    };
    Some(match named {
        NamedKey::Space => Key::Char(' '),
        NamedKey::ArrowUp => Key::Up,
        NamedKey::ArrowDown => Key::Down,
        NamedKey::ArrowLeft => Key::Left,
        NamedKey::ArrowRight => Key::Right,
        NamedKey::Shift => Key::Modifier(ModifierKeyCode::LeftShift),
        NamedKey::Control => Key::Modifier(ModifierKeyCode::LeftControl),
        NamedKey::Tab => Key::Tab,
        NamedKey::Escape => Key::Esc,
        NamedKey::PageUp => Key::PageUp,
        NamedKey::PageDown => Key::PageDown,
        NamedKey::Home => Key::Home,
        NamedKey::End => Key::End,
        NamedKey::F1 => Key::F(1),
        NamedKey::F5 => Key::F(5),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_of_other_keyboards_does_one_thing() {
        let typed = |physical, text: &str| {
            key_of(PhysicalKey::Code(physical), &winit::keyboard::Key::Character(text.into()))
        };
        let letter = |letter| Some(Key::Char(letter));
        for (physical, english, french) in [
            (KeyCode::KeyW, "w", "z"),
            (KeyCode::KeyA, "a", "q"),
            (KeyCode::KeyS, "s", "s"),
            (KeyCode::KeyD, "D", "D"),
        ] {
            assert_eq!(typed(physical, english), typed(physical, french), "walking follows the physical key");
        }
        assert_eq!(typed(KeyCode::KeyW, "z"), letter('w'));
        assert_eq!([typed(KeyCode::KeyQ, "q"), typed(KeyCode::KeyQ, "a")], [letter('q'); 2]);
        assert_eq!([typed(KeyCode::KeyZ, "z"), typed(KeyCode::KeyZ, "w")], [letter('z'); 2]);
        assert_eq!(typed(KeyCode::KeyZ, "y"), letter('y'), "a German Y");
        assert_eq!(typed(KeyCode::Semicolon, "M"), letter('m'), "others follow the layout");
        let named = |named| key_of(PhysicalKey::Code(KeyCode::F5), &winit::keyboard::Key::Named(named));
        assert_eq!([named(NamedKey::F5), named(NamedKey::F9)], [Some(Key::F(5)), None]);
    }
}
