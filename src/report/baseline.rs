//! Reports of `octray bench` that were made before, or by another program, and the ratios of a new one to
//! them.

use super::bench::{MeasuredScene, Over, Report, SCHEMA, table};
use super::settings::{differences, in_words, json};
use crate::measure::cores::Reliability;
use crate::measure::timed::Ratio;
use serde::Deserialize;
use serde_json::Value;

/// The part of an earlier report that is compared.
#[derive(Debug, Deserialize)]
pub struct Baseline {
    schema: String,
    /// The settings as JSON, because other versions have other ones.
    pub settings: Value,
    reliable: bool,
    scenes: Vec<MeasuredScene>,
    results: Vec<Speed>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
struct Speed {
    lanes: usize,
    threads: usize,
    fps_median: f64,
    fps_spread: [f64; 2],
    /// The default where an early version reports none.
    #[serde(flatten)]
    reliability: Reliability,
}

impl Speed {
    fn engine(&self) -> [usize; 2] {
        [self.lanes, self.threads]
    }
}

impl Baseline {
    /// Reads a report. The error says why `text` is none.
    pub fn read(text: &str) -> Result<Self, String> {
        let again = "make one with octray bench --json";
        let report: Self = serde_json::from_str(text)
            .map_err(|error| format!("it is no report of bench ({error}): {again}"))?;
        match report.schema == SCHEMA {
            true => Ok(report),
            false => Err(format!("it is of the form {}, not {SCHEMA}: {again}", report.schema)),
        }
    }

    /// Returns the speeds of the scene with the same content, or else with the same name.
    fn speeds(&self, scene: &MeasuredScene) -> Option<(&MeasuredScene, &[Speed])> {
        let engines = (self.results.len() / self.scenes.len().max(1)).max(1);
        let all = || self.scenes.iter().zip(self.results.chunks(engines));
        let same = all().find(|(old, _)| old.content == scene.content);
        same.or_else(|| all().find(|(old, _)| old.scene == scene.scene))
    }

    /// Adds to `report` its ratios to this one, and the settings in which the two differ. An engine is
    /// compared with that of the same width and number of threads; if there are no such pairs, the first with
    /// the first.
    pub fn compare(&self, report: &mut Report) {
        let mut found = differences(&json(&report.settings), &self.settings);
        let mut ratios = Vec::new();
        for (scene, results) in report.scenes.iter().zip(report.engines()) {
            let Some((old_scene, olds)) = self.speeds(scene) else { continue };
            let of_content = differences(&json(&scene.content), &json(&old_scene.content));
            let named = |(name, values)| (format!("{name} of {}", scene.scene), values);
            found.extend(of_content.into_iter().map(named));
            let like = |engine| olds.iter().find(|old| old.engine() == engine);
            let mut pairs: Vec<_> =
                results.iter().filter_map(|new| Some((new, like([new.lanes, new.threads])?))).collect();
            if pairs.is_empty() {
                pairs.extend(results.first().zip(olds.first()));
            }
            ratios.extend(pairs.into_iter().map(|(new, old)| {
                let rates = [(new.fps_median, new.fps_spread), (old.fps_median, old.fps_spread)];
                let (scene, there) = (scene.scene.clone(), old.engine());
                let ratio = new_over_old(rates, new.reliability, self.reliable);
                Over { scene, lanes: new.lanes, threads: new.threads, there, ratio }
            }));
        }
        report.over_baseline = Some(ratios);
        report.baseline_differences = Some(found);
    }
}

/// Returns the ratios of a report as a table.
pub fn text(report: &Report) -> String {
    let (Some(ratios), Some(differences)) = (&report.over_baseline, &report.baseline_differences) else {
        return String::new();
    };
    let none = if ratios.is_empty() { "The baseline has none of these scenes. " } else { "" };
    table(&(meaning("frames", "frames") + none + &in_words(differences)), ratios)
}

/// Returns the ratio of two rates, the new one first, each with its slow and its fast tenth. It is reliable
/// where both are.
pub fn new_over_old(
    [(new, [slow, fast]), (old, [old_slow, old_fast])]: [(f64, [f64; 2]); 2],
    of_new: Reliability,
    is_old_reliable: bool,
) -> Ratio {
    let reliability = Reliability { reliable: of_new.reliable && is_old_reliable, ..of_new };
    Ratio { median: new / old, spread: [slow / old_fast, fast / old_slow], rounds: 1, reliability }
}

/// Returns what ratios of [`new_over_old`] mean: of `what` per second, each the median of several `turns`.
pub fn meaning(what: &str, turns: &str) -> String {
    format!(
        "New over old, {what} per second: of the median {turns}, and in brackets from the slow tenth of the new over \
         the fast tenth of the old to the reverse. "
    )
}

/// Returns the ratios of one program to another on a scene, for the engines that both have timed. Each
/// program has made a report in each round.
pub fn over_rounds(scene: &str, [here, there]: &[Vec<Baseline>; 2]) -> Vec<Over> {
    let over = |first: &Speed| {
        let of = |reports: &[Baseline]| {
            let speed =
                |report: &Baseline| report.results.iter().find(|one| one.engine() == first.engine()).copied();
            reports.iter().map(speed).collect::<Option<Vec<Speed>>>()
        };
        let (here, there) = (of(here)?, of(there)?);
        let seconds = |speeds: &[Speed]| speeds.iter().map(|one| 1.0 / one.fps_median).collect::<Vec<_>>();
        let worse = here.iter().zip(&there).map(|(here, there)| here.reliability.worse(&there.reliability));
        let ratio = Ratio::of_rounds(&seconds(&here), &seconds(&there), &worse.collect::<Vec<_>>())?;
        let (scene, Speed { lanes, threads, .. }) = (scene.to_owned(), *first);
        Some(Over { scene, lanes, threads, there: first.engine(), ratio })
    };
    here.first().into_iter().flat_map(|report| report.results.iter().filter_map(over)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn rounds_of_two_programs_give_the_ratio_of_each_engine_that_both_have() {
        let report = |engines: &[(usize, f64)]| {
            let result = |&(lanes, fps): &(usize, f64)| {
                json!({ "lanes": lanes, "threads": 1, "fps_median": fps, "fps_spread": [fps, fps],
                        "reliable": true, "pinned": true, "taken": 0.01 })
            };
            let results: Vec<Value> = engines.iter().map(result).collect();
            let report = json!({ "schema": SCHEMA, "settings": {}, "reliable": true, "scenes": [], "results": results });
            Baseline::read(&report.to_string()).unwrap()
        };
        let here = [1.0, 0.5, 2.0].map(|fps| report(&[(8, 6.0 * fps), (1, fps), (16, 9.0)]));
        // In the second round the machine is half as fast.
        let there = [1.0, 0.5, 1.0].map(|fps| report(&[(1, fps), (8, 2.0 * fps)]));
        let found = over_rounds("s", &[here.into(), there.into()]);
        let found = found
            .iter()
            .map(|over| (over.lanes, over.ratio.median, over.ratio.spread, over.ratio.reliability.reliable));
        assert_eq!(found.collect::<Vec<_>>(), [(8, 3.0, [3.0, 6.0], true), (1, 1.0, [1.0, 2.0], true)]);
    }
}
