//! Loops that touch no memory: the clock, and what threads give where nothing is shared.
//!
//!     compute clock              GHz
//!     compute fma THREADS        billions of steps a second, of all threads together
//!     compute steps N            N steps, for counting
//!
//! A step is CHAINS fused multiply-adds of eight lanes. A multiply-add is ready after 4 cycles and two start
//! in a cycle, so 8 chains would do; 12 and the two constants stay within the 16 registers.

use std::hint::black_box;
use std::sync::Barrier;
use std::time::{Duration, Instant};

const CHAINS: usize = 12;
const LANES: usize = 8;
/// Length of a measurement.
const TIME: Duration = Duration::from_millis(250);

/// The factor is below 1 and the sum positive: values converge and are never denormal.
#[inline(never)]
fn steps(count: u64) -> f32 {
    let (factor, offset) = (black_box(0.5_f32), black_box(1.0_f32));
    let mut chains = black_box([[0.0_f32; LANES]; CHAINS]);
    for _ in 0..count {
        for lane in chains.as_flattened_mut() {
            *lane = lane.mul_add(factor, offset);
        }
    }
    chains.as_flattened().iter().sum()
}

/// Steps of two instructions that wait for each other, one cycle each. Sums of two registers: current
/// processors add small constants while they rename registers, which takes no time.
#[inline(never)]
fn dependent(count: u64) -> u64 {
    let (add, flip) = (black_box(0x1234_5678_u64), black_box(0x0f0f_0f0f_u64));
    (0..count).fold(black_box(1), |value, _| value.wrapping_add(add) ^ flip)
}

/// Billions of steps a second.
fn rate(batch: u64, run: impl Fn(u64)) -> f64 {
    let (begin, mut count) = (Instant::now(), 0);
    while begin.elapsed() < TIME {
        run(batch);
        count += batch;
    }
    count as f64 / begin.elapsed().as_nanos() as f64
}

fn main() {
    let words: Vec<String> = std::env::args().collect();
    let number = || words.get(2).and_then(|word| word.parse::<u64>().ok()).expect("a number");
    match words.get(1).map(String::as_str) {
        Some("clock") => println!("{}", 2.0 * rate(1 << 20, |count| _ = black_box(dependent(count)))),
        Some("fma") => {
            let start = Barrier::new(number() as usize);
            let one = || {
                start.wait();
                rate(1 << 18, |count| _ = black_box(steps(count)))
            };
            let sum: f64 = std::thread::scope(|scope| {
                let threads: Vec<_> = (0..number()).map(|_| scope.spawn(one)).collect();
                threads.into_iter().map(|thread| thread.join().expect("a thread")).sum()
            });
            println!("{sum}");
        }
        Some("steps") => println!("{}", steps(number())),
        _ => std::process::exit(2),
    }
}
