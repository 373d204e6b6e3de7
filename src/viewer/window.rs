//! The window: reports keys and mouse, shows frames.
//!
//! For: [`window()`]. May import: `winit`, `softbuffer`, `canvas`. Must never know: scenes, renderers.

use super::canvas::Canvas;
use super::frame::Frame;
use super::keys::Key;
use super::playlist::Playlist;
use super::state::Event;
use super::told::Told;
use super::{Options, Summary, Viewer};
use crate::scene::Loaded;
use std::num::NonZeroU32;
use std::rc::Rc;
use std::sync::Arc;
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::dpi::{LogicalSize, PhysicalSize};
use winit::error::EventLoopError;
use winit::event::{DeviceEvent, DeviceId, ElementState, MouseButton, MouseScrollDelta, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, OwnedDisplayHandle};
use winit::keyboard::{KeyCode, NamedKey, PhysicalKey};
use winit::window::{CursorGrabMode, Window, WindowId};

/// Side of the window's pixels for one of the picture's, where the screen has room.
const ENLARGED: f64 = 4.0;
/// Longest wait for anything before it is asked whether the program is to end.
const PATIENCE: Duration = Duration::from_millis(100);
/// The share of the screen that the window may take at first.
const MOST_OF_SCREEN: f64 = 0.9;

/// Why there is no window.
#[derive(Debug, thiserror::Error)]
pub enum WindowError {
    #[error(
        "{0}\n  octray view --terminal shows the scene in a terminal, octray render writes it into a file"
    )]
    NoDisplay(String),
    #[error(
        "the window cannot be drawn in\n  octray view --terminal shows the scene in a terminal, octray render writes it into a file"
    )]
    NoSurface(#[source] Box<dyn std::error::Error + Send + Sync>),
}

/// What showing frames took.
#[derive(Clone, Debug, Default)]
pub struct Presented {
    /// Frames drawn, and the time for enlarging, writing over, and handing them to the display.
    pub frames: u64,
    pub time: Duration,
}

/// A frame is there.
struct Fresh;

/// Opens a window on a scene and stays until it is closed.
pub fn window(
    options: Options,
    playlist: Playlist,
    scene: Loaded,
) -> Result<(Summary, Presented), WindowError> {
    let events = event_loop().map_err(|_| no_display())?;
    let context = softbuffer::Context::new(events.owned_display_handle())
        .map_err(|error| WindowError::NoSurface(error.to_string().into()))?;
    let proxy = events.create_proxy();
    let size = options.size.unwrap_or(scene.resolution);
    let wake = Arc::new(move || {
        // A loop that has ended shows nothing more.
        let _ = proxy.send_event(Fresh);
    });
    let viewer = Viewer::start(options, playlist, scene, wake);
    let mut app = App {
        viewer,
        told: Told::listen().ok(),
        size,
        context,
        surface: None,
        frame: Frame::default(),
        columns: Vec::new(),
        room: PhysicalSize::default(),
        title: String::new(),
        caught: false,
        presented: Presented::default(),
        failure: None,
    };
    events.run_app(&mut app).map_err(|_| no_display())?;
    let App { viewer, presented, failure, .. } = app;
    let summary = viewer.finish();
    match failure {
        Some(failure) => Err(failure),
        None => Ok((summary, presented)),
    }
}

/// Of Wayland where that answers, else of X, where the system has both.
fn event_loop() -> Result<EventLoop<Fresh>, EventLoopError> {
    let mut builder = EventLoop::with_user_event();
    #[cfg(target_os = "linux")]
    if !wayland::answers() {
        winit::platform::x11::EventLoopBuilderExtX11::with_x11(&mut builder);
    }
    builder.build()
}

/// Whether there is a Wayland compositor: a variable may speak of one that is over, or of another user's.
#[cfg(target_os = "linux")]
mod wayland {
    use std::env::var_os;
    use std::fs;
    use std::os::unix::fs::FileTypeExt;
    use std::os::unix::net::UnixStream;
    use std::path::Path;

    pub fn answers() -> bool {
        if let Some(open) = var_os("WAYLAND_SOCKET").filter(|open| !open.is_empty()) {
            // The number of a connection that whoever started this program has opened for it.
            let open = fs::metadata(Path::new("/proc/self/fd").join(open));
            return open.is_ok_and(|open| open.file_type().is_socket());
        }
        let Some(name) = var_os("WAYLAND_DISPLAY").filter(|name| !name.is_empty()) else { return false };
        let folder = var_os("XDG_RUNTIME_DIR").unwrap_or_default();
        UnixStream::connect(Path::new(&folder).join(name)).is_ok()
    }
}

/// What the system's own words, which tell of its sources, do not say.
fn no_display() -> WindowError {
    let named = ["WAYLAND_SOCKET", "WAYLAND_DISPLAY", "DISPLAY"].into_iter().filter_map(|name| {
        let display = std::env::var(name).ok().filter(|display| !display.is_empty())?;
        Some(format!("{name}={display}"))
    });
    let named: Vec<String> = named.collect();
    WindowError::NoDisplay(match named.is_empty() {
        false => format!("there is no display to open a window on: none answers at {}", named.join(" or ")),
        true => "there is no display to open a window on".to_string(),
    })
}

type Surface = softbuffer::Surface<OwnedDisplayHandle, Rc<Window>>;

struct App {
    viewer: Viewer,
    /// Nothing where the system lets nobody listen.
    told: Option<Told>,
    /// Pixels of the first picture.
    size: [u32; 2],
    context: softbuffer::Context<OwnedDisplayHandle>,
    surface: Option<Surface>,
    frame: Frame,
    columns: Vec<u32>,
    /// Pixels of the window, as it told last: whoever asks a window that is gone already ends in a panic.
    room: PhysicalSize<u32>,
    /// The frame's title that the window has.
    title: String,
    /// Is the mouse caught?
    caught: bool,
    presented: Presented,
    failure: Option<WindowError>,
}

impl App {
    fn open(&mut self, events: &ActiveEventLoop) -> Result<Surface, WindowError> {
        let refused = |error: String| WindowError::NoSurface(error.into());
        let monitor = events.primary_monitor().or_else(|| events.available_monitors().next());
        let [width, height] = self.size.map(f64::from);
        let mut enlarged = ENLARGED;
        if let Some(monitor) = &monitor {
            let screen = monitor.size().to_logical::<f64>(monitor.scale_factor());
            if screen.width > 0.0 && screen.height > 0.0 {
                let most = (screen.width / width).min(screen.height / height) * MOST_OF_SCREEN;
                enlarged = enlarged.min(most);
            }
            if let Some(rate) = monitor.refresh_rate_millihertz() {
                self.viewer.send(Event::Rate(f64::from(rate) / 1e3));
            }
        }
        let size = LogicalSize::new((width * enlarged).max(160.0), (height * enlarged).max(90.0));
        let attributes = Window::default_attributes().with_title("octray").with_inner_size(size);
        let window = events.create_window(attributes).map_err(|error| refused(error.to_string()))?;
        self.room = window.inner_size();
        Surface::new(&self.context, Rc::new(window)).map_err(|error| refused(error.to_string()))
    }

    /// Shows the newest frame, or the last one again.
    fn draw(&mut self) -> Result<(), WindowError> {
        let Some(surface) = &mut self.surface else { return Ok(()) };
        let fresh = self.viewer.take(&mut self.frame);
        let PhysicalSize { width: across, height: down } = self.room;
        let (Some(width), Some(height)) = (NonZeroU32::new(across), NonZeroU32::new(down)) else {
            return Ok(());
        };
        let start = Instant::now();
        let refused = |error: softbuffer::SoftBufferError| WindowError::NoSurface(error.to_string().into());
        surface.resize(width, height).map_err(refused)?;
        let mut buffer = surface.buffer_mut().map_err(refused)?;
        Canvas { pixels: &mut buffer, width: across, height: down }.show(&self.frame, &mut self.columns);
        buffer.present().map_err(refused)?;
        if fresh {
            self.presented.frames += 1;
            self.presented.time += start.elapsed();
            if self.title != self.frame.title {
                self.title.clone_from(&self.frame.title);
                surface.window().set_title(&format!("octray · {}", self.title));
            }
        }
        self.catch();
        Ok(())
    }

    /// Catches the mouse, or lets it go, as the frame says.
    fn catch(&mut self) {
        let Some(surface) = &self.surface else { return };
        if self.frame.caught == self.caught {
            return;
        }
        self.caught = self.frame.caught;
        let window = surface.window();
        let mode = if self.caught { CursorGrabMode::Locked } else { CursorGrabMode::None };
        let grabbed = window.set_cursor_grab(mode);
        if self.caught && grabbed.is_err() {
            // Where the pointer cannot be locked it is kept inside; where neither is possible it turns the camera all the same.
            let _ = window.set_cursor_grab(CursorGrabMode::Confined);
        }
        window.set_cursor_visible(!self.caught);
    }

    fn key(&self, event: &winit::event::KeyEvent) {
        if let Some(key) = key_of(event.physical_key, &event.logical_key) {
            let down = event.state == ElementState::Pressed;
            self.viewer.send(Event::Key { key, down, repeat: event.repeat });
        }
    }
}

impl ApplicationHandler<Fresh> for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.surface.is_none() {
            match self.open(events) {
                Ok(surface) => self.surface = Some(surface),
                Err(failure) => {
                    self.failure = Some(failure);
                    events.exit();
                }
            }
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        if self.viewer.is_over() || self.told.as_ref().is_some_and(Told::to_end) {
            return events.exit();
        }
        events.set_control_flow(ControlFlow::WaitUntil(Instant::now() + PATIENCE));
    }

    fn user_event(&mut self, _: &ActiveEventLoop, _: Fresh) {
        if let Some(surface) = &self.surface {
            surface.window().request_redraw();
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        match event {
            WindowEvent::CloseRequested | WindowEvent::Destroyed => events.exit(),
            WindowEvent::Resized(size) => self.room = size,
            WindowEvent::RedrawRequested => {
                if let Err(failure) = self.draw() {
                    self.failure = Some(failure);
                    events.exit();
                }
            }
            // Keys that were down when the window came to the fore were pressed for somebody else.
            WindowEvent::KeyboardInput { is_synthetic: true, .. } => {}
            WindowEvent::KeyboardInput { event, .. } => self.key(&event),
            WindowEvent::Focused(false) => self.viewer.send(Event::Unfocused),
            WindowEvent::MouseInput { state: ElementState::Pressed, button: MouseButton::Left, .. } => {
                self.viewer.send(Event::Click);
            }
            WindowEvent::MouseWheel { delta, .. } => self.viewer.send(Event::Wheel(match delta {
                MouseScrollDelta::LineDelta(_, lines) => f64::from(lines),
                MouseScrollDelta::PixelDelta(travel) => travel.y / 40.0,
            })),
            WindowEvent::DroppedFile(path) => {
                self.viewer.send(Event::Dropped(path.to_string_lossy().into_owned()));
            }
            _ => {}
        }
    }

    fn device_event(&mut self, _: &ActiveEventLoop, _: DeviceId, event: DeviceEvent) {
        if let (DeviceEvent::MouseMotion { delta: (right, down) }, true) = (event, self.caught) {
            self.viewer.send(Event::Mouse([right, down]));
        }
    }
}

/// The key, if it is one of ours. Letters for walking are told by where they are on the keyboard, others by what is written on them.
fn key_of(place: PhysicalKey, written: &winit::keyboard::Key) -> Option<Key> {
    let letter = match written {
        winit::keyboard::Key::Character(text) => text.chars().flat_map(char::to_lowercase).next(),
        _ => None,
    };
    let is = |wanted| letter == Some(wanted);
    if let PhysicalKey::Code(code) = place {
        match code {
            KeyCode::KeyW => return Some(Key::Char('w')),
            KeyCode::KeyA => return Some(Key::Char('a')),
            KeyCode::KeyS => return Some(Key::Char('s')),
            KeyCode::KeyD => return Some(Key::Char('d')),
            // Where A and W are written on French keyboards.
            KeyCode::KeyQ if is('a') => return Some(Key::Char('q')),
            KeyCode::KeyZ if is('w') => return Some(Key::Char('z')),
            _ => {}
        }
    }
    match written {
        winit::keyboard::Key::Character(_) => letter.map(Key::Char),
        winit::keyboard::Key::Named(named) => match named {
            NamedKey::Space => Some(Key::Char(' ')),
            NamedKey::ArrowUp => Some(Key::Up),
            NamedKey::ArrowDown => Some(Key::Down),
            NamedKey::ArrowLeft => Some(Key::Left),
            NamedKey::ArrowRight => Some(Key::Right),
            NamedKey::Shift => Some(Key::Shift),
            NamedKey::Control => Some(Key::Control),
            NamedKey::Tab => Some(Key::Tab),
            NamedKey::Escape => Some(Key::Escape),
            NamedKey::PageUp => Some(Key::PageUp),
            NamedKey::PageDown => Some(Key::PageDown),
            NamedKey::Home => Some(Key::Home),
            NamedKey::F1 => Some(Key::F1),
            NamedKey::F5 => Some(Key::F5),
            _ => None,
        },
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_of_other_keyboards_does_one_thing() {
        let typed = |place, text: &str| {
            key_of(PhysicalKey::Code(place), &winit::keyboard::Key::Character(text.into()))
        };
        let letter = |letter| Some(Key::Char(letter));
        for (place, english, french) in [
            (KeyCode::KeyW, "w", "z"),
            (KeyCode::KeyA, "a", "q"),
            (KeyCode::KeyS, "s", "s"),
            (KeyCode::KeyD, "D", "D"),
        ] {
            assert_eq!(typed(place, english), typed(place, french), "walking is told by place");
        }
        assert_eq!(typed(KeyCode::KeyW, "z"), letter('w'));
        assert_eq!([typed(KeyCode::KeyQ, "q"), typed(KeyCode::KeyQ, "a")], [letter('q'); 2]);
        assert_eq!([typed(KeyCode::KeyZ, "z"), typed(KeyCode::KeyZ, "w")], [letter('z'); 2]);
        assert_eq!(typed(KeyCode::KeyZ, "y"), letter('y'), "a German Y");
        assert_eq!(typed(KeyCode::Semicolon, "M"), letter('m'), "others by what is written on them");
        let named = |named| key_of(PhysicalKey::Code(KeyCode::F5), &winit::keyboard::Key::Named(named));
        assert_eq!([named(NamedKey::F5), named(NamedKey::F9)], [Some(Key::F5), None]);
    }
}
