//! Separable filters: one in x, then one in y.
//!
//! Beyond the border, the nearest pixel repeats.

/// The weights of a filter in one direction. Their number is odd; the middle one weighs the pixel itself.
#[derive(Clone, Debug)]
pub struct Kernel(Vec<f32>);

/// Returns `weight(x)` at the integers x within `radius`.
fn sampled(radius: usize, weight: impl Fn(f64) -> f64) -> Vec<f64> {
    let radius = radius as i32;
    (-radius..=radius).map(|x| weight(f64::from(x))).collect()
}

impl Kernel {
    /// Builds a kernel whose weights sum to 1, without ends below f32's resolution of the middle one.
    pub fn blur(radius: usize, weight: impl Fn(f64) -> f64) -> Self {
        let (middle, resolution) = (weight(0.0), f64::from(f32::EPSILON) / 16.0);
        let needed = (0..=radius).rev().find(|&x| weight(x as f64) > middle * resolution);
        let weights = sampled(needed.unwrap_or(0), weight);
        let scale = 1.0 / weights.iter().sum::<f64>();
        Self(weights.into_iter().map(|weight| (weight * scale) as f32).collect())
    }
    /// Builds a kernel whose positive weights sum to 1 and whose negative ones sum to −1.
    pub fn difference(radius: usize, weight: impl Fn(f64) -> f64) -> Self {
        let weights = sampled(radius, weight);
        let scale = |sign: f64| 1.0 / weights.iter().map(|weight| (sign * weight).max(0.0)).sum::<f64>();
        let [positive, negative] = [1.0, -1.0].map(scale);
        let scaled = |&weight: &f64| weight * if weight > 0.0 { positive } else { negative };
        Self(weights.iter().map(|weight| scaled(weight) as f32).collect())
    }
    fn radius(&self) -> usize {
        self.0.len() / 2
    }
}

/// Adds `weight · values` to `sum`, element by element.
fn add(sum: &mut [f32], weight: f32, values: &[f32]) {
    sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
}

/// Returns the picture filtered along its rows of `width` pixels, by each kernel.
pub fn rows<const N: usize>(values: &[f32], width: usize, kernels: [&Kernel; N]) -> [Vec<f32>; N] {
    let radius = kernels.iter().map(|kernel| kernel.radius()).max().unwrap_or(0);
    let mut padded = vec![0.0; width + 2 * radius];
    let mut filtered = kernels.map(|_| vec![0.0; values.len()]);
    for (y, row) in values.chunks_exact(width).enumerate() {
        padded[..radius].fill(row[0]);
        padded[radius..radius + width].copy_from_slice(row);
        padded[radius + width..].fill(row[width - 1]);
        for (kernel, filtered) in kernels.iter().zip(&mut filtered) {
            let from = radius - kernel.radius();
            for (i, &weight) in kernel.0.iter().enumerate() {
                add(&mut filtered[y * width..][..width], weight, &padded[from + i..]);
            }
        }
    }
    filtered
}

/// Returns the picture filtered along its columns.
pub fn columns(values: &[f32], width: usize, kernel: &Kernel) -> Vec<f32> {
    let (height, radius) = (values.len() / width, kernel.radius());
    let mut filtered = vec![0.0; values.len()];
    for (y, sum) in filtered.chunks_exact_mut(width).enumerate() {
        for (i, &weight) in kernel.0.iter().enumerate() {
            let from = (y + i).saturating_sub(radius).min(height - 1);
            add(sum, weight, &values[from * width..][..width]);
        }
    }
    filtered
}
