//! Memory of large pictures, checked before a rendering starts.

use super::error::CliError;
use super::terminal;
use crate::film::Film;
use crate::film::noise::Noise;
use crate::machine;
use indicatif::DecimalBytes;

/// A picture that takes more bytes than this, or more than this share of the available memory, gets a
/// warning.
const LARGE: u64 = 2_000_000_000;
const LARGE_SHARE: f64 = 0.25;

/// Warns of a picture that takes much memory, and refuses one that takes more than the system calls
/// available.
pub fn check(size: [u32; 2], bytes_per_pixel: usize) -> Result<(), CliError> {
    let warning = judge(size, bytes_per_pixel, machine::available_memory()).map_err(CliError::Input)?;
    warning.iter().for_each(|sentence| terminal::warn(sentence));
    Ok(())
}

/// The bytes that `--denoise` takes for a pixel: 48 each for the AOVs and those of the denoiser, and its
/// working memory. `--aovs` takes less.
const DENOISER_BYTES_PER_PIXEL: usize = 190;

/// Checks a film, which needs more memory to estimate errors and to be denoised.
pub fn check_film(size: [u32; 2], with_noise: bool, with_aovs: bool) -> Result<(), CliError> {
    let more = [(with_noise, Noise::BYTES_PER_PIXEL), (with_aovs, DENOISER_BYTES_PER_PIXEL)];
    let more = more.into_iter().filter(|(is_taken, _)| *is_taken).map(|(_, bytes)| bytes);
    check(size, Film::BYTES_PER_PIXEL + more.sum::<usize>())
}

/// Returns the reason why a picture of this size is refused, without printing a warning.
#[cfg(feature = "viewer")]
pub fn room_for(size: [u32; 2], bytes_per_pixel: usize) -> Result<(), String> {
    judge(size, bytes_per_pixel, machine::available_memory()).map(drop)
}

/// Returns the warning about a picture of this size, if there is one; the error refuses it.
fn judge(size: [u32; 2], bytes_per_pixel: usize, available: Option<u64>) -> Result<Option<String>, String> {
    let [width, height] = size;
    let needed = u64::from(width) * u64::from(height) * bytes_per_pixel as u64;
    let takes = format!("{width}×{height} pixels take about {} of memory", DecimalBytes(needed));
    match available {
        Some(available) if needed > available => {
            // Same aspect ratio, smaller.
            let shrink = (available as f64 / needed as f64).sqrt();
            let [width, height] = size.map(|side| ((f64::from(side) * shrink) as u32).max(1));
            let mend = format!("give a smaller one, such as --size {width}x{height}, or end other programs");
            Err(format!("{takes}, and {} are available\n  {mend}", DecimalBytes(available)))
        }
        Some(available) if needed > LARGE || needed as f64 > LARGE_SHARE * available as f64 => {
            Ok(Some(format!("{takes}; {} are available.", DecimalBytes(available))))
        }
        None if needed > LARGE => Ok(Some(format!("{takes}."))),
        _ => Ok(None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn judge_warns_of_large_pictures_and_refuses_what_does_not_fit() {
        let judged = |size, available| judge(size, 40, available).map(Option::unwrap_or_default);
        for (size, available) in
            [([240, 135], Some(1_000_000_000)), ([240, 135], None), ([7000, 7000], Some(100_000_000_000))]
        {
            assert_eq!(judged(size, available), Ok(String::new()));
        }
        let large = "8000×8000 pixels take about 2.56 GB of memory";
        assert_eq!(judged([8000, 8000], None).unwrap(), format!("{large}."));
        let said = judged([8000, 8000], Some(100_000_000_000)).unwrap();
        assert_eq!(said, format!("{large}; 100.00 GB are available."));
        let fits = judged([1000, 1000], Some(40_000_000)).unwrap();
        assert!(fits.contains("40.00 MB are available"), "more than a quarter, and it just fits: {fits}");
        let refused = judged([16_384, 8_192], Some(1_000_000_000)).unwrap_err();
        assert!(refused.contains("5.37 GB") && refused.contains("--size 7071x3535"), "{refused}");
    }
}
