//! Reads the image statements of MTL files, and loads their textures.

use super::builder::{SceneBuilder, UvTransform};
use super::error::SceneError;
use super::notes::Notes;
use super::relief::{self, Channel};
use super::statements::Statement;
use super::texture::{Change, Lookup};
use glam::DVec2;
use octray_engine::scene::{Filter, TexelKind, Wrap};
use std::path::Path;

/// An image file and its options.
pub struct Map {
    pub file: String,
    pub line: usize,
    /// The keyword, for messages.
    shown: String,
    /// Whether it is a map of heights.
    is_bump: bool,
    /// `-s` and `-o`.
    pub uvs: UvTransform,
    /// `-bm`, the factor of heights and slopes.
    bump: f64,
    /// `-clamp`.
    wrap: Wrap,
    /// `-imfchan`, of maps of heights and other numbers.
    channel: Option<&'static str>,
}

/// The channels that `-imfchan` names; the last one is the luminance of Rec. 709.
const CHANNELS: [(&str, Channel); 4] =
    [(RED, [1.0, 0.0, 0.0]), ("g", [0.0, 1.0, 0.0]), ("b", [0.0, 0.0, 1.0]), ("l", [0.2126, 0.7152, 0.0722])];
const RED: &str = "r";

/// The options, each followed by the values that have no effect. Only the first value is required.
const OPTIONS: &str = "-blendu on -blendv on -bm 1 -boost 0 -cc off -clamp off -imfchan rgb -mm 0 1 -o 0 0 0 -s 1 1 1 \
                       -t 0 0 0 -texres _ -type _ -colorspace _";

impl Map {
    /// Reads a statement of options and then a file name, which may hold spaces; `-bm` may follow the name.
    /// Options that are not read are noted, unless they have no effect.
    pub fn read(statement: &Statement, notes: &mut Notes) -> Result<Self, SceneError> {
        let nothing = || statement.fault("there is no file name", "write the path of an image");
        let line = statement.line;
        let mut map = Self {
            file: String::new(),
            line,
            shown: statement.shown(),
            is_bump: is_bump(statement.keyword()),
            uvs: UvTransform::IDENTITY,
            bump: 1.0,
            wrap: Wrap::Repeat,
            channel: None,
        };
        let rest = statement.name();
        let mut rest = rest.as_str();
        while rest.starts_with('-') {
            let (option, after) = rest.split_once(char::is_whitespace).ok_or_else(nothing)?;
            let after_option = OPTIONS.split(' ').skip_while(|word| *word != option).skip(1);
            let idle: Vec<&str> = after_option.take_while(|word| !word.starts_with('-')).collect();
            if idle.is_empty() {
                break;
            }
            rest = after.trim_start();
            let (mut values, mut asks) = (Vec::new(), false);
            for (number, idle) in idle.into_iter().enumerate() {
                // The last word is the file's.
                let Some((word, after)) = rest.split_once(char::is_whitespace) else { break };
                // Further values are numbers, and so is the first one of some options.
                let value = word.parse::<f64>();
                if value.is_err() && (number > 0 || idle.parse::<f64>().is_ok()) {
                    break;
                }
                asks |= word != idle && !idle.parse().is_ok_and(|idle: f64| value == Ok(idle));
                values.push(word);
                rest = after.trim_start();
            }
            if asks && !map.set(option, &values, statement)? {
                notes.add(&line, format!("the option `{option}` of {} is not read", map.shown));
            }
        }
        if let Some((name, value)) = rest.rsplit_once(" -bm ")
            && value.trim().parse::<f64>().is_ok()
        {
            map.set("-bm", &[value.trim()], statement)?;
            rest = name.trim_end();
        }
        if rest.is_empty() {
            return Err(nothing());
        }
        map.file = rest.to_string();
        Ok(map)
    }

    /// Sets an option to these values. Returns false for one that this map does not have.
    fn set(&mut self, option: &str, values: &[&str], statement: &Statement) -> Result<bool, SceneError> {
        let number = |at: usize, missing: f64| {
            values.get(at).map_or(Ok(missing), |word| statement.number(word.as_bytes()))
        };
        let keyword = statement.keyword();
        match option {
            "-s" => self.uvs.scale = DVec2::new(number(0, 1.0)?, number(1, 1.0)?),
            "-o" => self.uvs.offset = DVec2::new(number(0, 0.0)?, number(1, 0.0)?),
            "-bm" if self.is_bump || NORMALS.contains(&keyword) => self.bump *= number(0, 1.0)?,
            // A base height moves the whole surface.
            "-mm" if self.is_bump => self.bump *= number(1, 1.0)?,
            "-clamp" => self.wrap = if values == ["on"] { Wrap::Clamp } else { Wrap::Repeat },
            "-imfchan" if self.is_bump || NUMBERS.contains(&keyword) => {
                let named = CHANNELS.iter().find(|(name, _)| values == [*name]);
                self.channel = named.map(|(name, _)| *name);
                return Ok(named.is_some());
            }
            // The alpha channel.
            "-imfchan" if keyword == b"map_d" && values == ["m"] => {}
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// Returns the channel of numbers, `otherwise` without `-imfchan`, and its name unless it is that one.
    fn channel(&self, otherwise: &'static str) -> (Channel, String) {
        let channel = self.channel.unwrap_or(otherwise);
        let weights = CHANNELS.iter().find(|(name, _)| *name == channel).map(|(_, weights)| *weights);
        let shown = if channel == otherwise { String::new() } else { format!(", channel {channel}") };
        (weights.unwrap_or_default(), shown)
    }

    /// Loads a map of colours, or notes why it is left out.
    pub fn color(&self, beside: [&Path; 2], builder: &mut SceneBuilder) -> Option<u32> {
        self.load(beside, TexelKind::Color, "", builder, &mut |_, image| image)
    }

    /// Loads a map of normals, or the normals of a map of heights.
    pub fn normals(&self, beside: [&Path; 2], builder: &mut SceneBuilder) -> Option<u32> {
        let Self { is_bump, bump: scale, .. } = *self;
        let (channel, shown) = self.channel("l");
        let what = match (is_bump, scale) {
            (true, _) => format!("{shown}, relief times {scale}"),
            (false, 1.0) => String::new(),
            (false, _) => format!(", slopes times {scale}"),
        };
        let mut is_misnamed = false;
        let map = self.load(beside, TexelKind::Data, &what, builder, &mut |_, image| {
            is_misnamed = is_bump && relief::are_normals(&image.2);
            let texels = match is_bump && !is_misnamed {
                true => relief::normals(&image, channel, scale, self.wrap),
                false if scale == 1.0 => image.2,
                false => relief::scale_slopes(&image.2, scale),
            };
            (image.0, image.1, texels)
        });
        if is_misnamed {
            let what =
                format!("the image of {} is a normal map and is read as one: write `norm`", self.shown);
            builder.notes.add(&self.line, what);
        }
        map
    }

    /// Loads a map of opacity: the alpha channel, or the grey of an image without one.
    pub fn opacity(&self, beside: [&Path; 2], builder: &mut SceneBuilder) -> Option<u32> {
        self.load(beside, TexelKind::AlphaOrGrey, "", builder, &mut |_, image| image)
    }

    /// Loads a map of numbers, as the red channel of a texture.
    pub fn numbers(&self, beside: [&Path; 2], builder: &mut SceneBuilder) -> Option<u32> {
        let (channel, what) = self.channel(RED);
        self.load(beside, TexelKind::Data, &what, builder, &mut |_, image| match what.as_str() {
            "" => image,
            _ => relief::packed(Some((&image, channel)), (&image, channel), self.wrap),
        })
    }

    /// Loads this map of the metallic share and one of roughness, packed into one texture.
    pub fn packed_with(
        &self,
        roughness: Option<&Self>,
        beside: [&Path; 2],
        builder: &mut SceneBuilder,
    ) -> Option<u32> {
        let (channel, shown) = self.channel(RED);
        let rough = roughness.map(|map| (map, map.channel(RED)));
        let what =
            rough.as_ref().map_or(String::new(), |(map, (_, shown))| format!(" and {}{shown}", map.file));
        let (what, mut reason) = (format!("{shown}, metallic{what}"), None);
        let map = self.load(beside, TexelKind::Data, &what, builder, &mut |textures, metal| {
            let rough = rough.as_ref().and_then(|(map, (channel, _))| {
                let image = textures.find_image(&map.file, beside, TexelKind::Data);
                Some((image.map_err(|why| reason = Some((map.line, map.left_out(&why)))).ok()?, *channel))
            });
            let rough = rough.as_ref().map(|(image, channel)| (image, *channel));
            relief::packed(rough, (&metal, channel), self.wrap)
        });
        reason.into_iter().for_each(|(line, what)| builder.notes.add(&line, what));
        map
    }

    fn left_out(&self, why: &str) -> String {
        format!("the texture `{}` is left out: {why}", self.file)
    }

    fn load(
        &self,
        beside: [&Path; 2],
        kind: TexelKind,
        what: &str,
        builder: &mut SceneBuilder,
        change: &mut Change,
    ) -> Option<u32> {
        let lookup = Lookup { filter: Filter::Bilinear, wrap: [self.wrap; 2], kind };
        let found = builder.textures.find_changed(&self.file, beside, lookup, what, change);
        found.map_err(|why| builder.notes.add(&self.line, self.left_out(&why))).ok()
    }
}

/// The statements of maps of numbers.
const NUMBERS: [&[u8]; 2] = [b"map_Pr", b"map_Pm"];
/// The statements of maps of normals.
const NORMALS: [&[u8]; 2] = [b"norm", b"map_Kn"];

/// Tests whether this is one of the keywords of maps of heights.
pub fn is_bump(keyword: &[u8]) -> bool {
    [&b"map_bump"[..], b"bump"].iter().any(|known| keyword.eq_ignore_ascii_case(known))
}
