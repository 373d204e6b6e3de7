//! `octray bench --baseline`: an earlier report of the command, and the ratios of a new one to it.
//!
//! For: [`Baseline`].

use super::bench::{MeasuredScene, OverBaseline, Report, SCHEMA, engine_name};
use super::numbers::ratio;
use super::settings::RunSettings;
use super::text::{if_doubtful, paragraph, row};
use crate::machine::Machine;
use crate::measure::bench::Engine;
use crate::measure::timed::Ratio;
use serde::Deserialize;

/// What is read of a report.
#[derive(Debug, Deserialize)]
pub struct Baseline {
    schema: String,
    settings: RunSettings,
    reliable: bool,
    scenes: Vec<MeasuredScene>,
    results: Vec<Speed>,
}

#[derive(Debug, Deserialize)]
struct Speed {
    lanes: usize,
    threads: usize,
    fps_median: f64,
    fps_spread: [f64; 2],
}

impl Speed {
    fn is_of(&self, lanes: usize, threads: usize) -> bool {
        (self.lanes, self.threads) == (lanes, threads)
    }
}

impl Baseline {
    /// Reads a report; otherwise the reason why it is none.
    pub fn read(text: &str) -> Result<Self, String> {
        let again = "make one with octray bench --json";
        let report: Self = serde_json::from_str(text)
            .map_err(|error| format!("it is no report of bench ({error}): {again}"))?;
        match report.schema == SCHEMA {
            true => Ok(report),
            false => Err(format!("it is of the form {}, not {SCHEMA}: {again}", report.schema)),
        }
    }

    /// Refuses other settings, other engines and other scenes.
    pub fn check(
        &self,
        settings: &RunSettings,
        engines: &[Engine],
        scenes: &[MeasuredScene],
    ) -> Result<(), String> {
        // Engines are paired one by one, and the number of frames changes no rate.
        let comparable = |run: &RunSettings| {
            let mut more = run.more.clone();
            more.remove("frames");
            RunSettings { lanes: Vec::new(), threads: Vec::new(), more, ..run.clone() }
        };
        let [old, new] = [&self.settings, settings].map(comparable);
        let (olds, news) = (old.options(&new), new.options(&old));
        if olds != news {
            return Err(format!("it has other settings: {olds}, here {news}; give the same"));
        }
        if let Some(scene) = scenes.iter().find(|scene| self.scenes.iter().all(|old| !old.is_same(scene))) {
            let name = &scene.scene;
            if let Some(old) = self.scenes.iter().find(|old| old.scene == *name) {
                let changes = old.changes(scene);
                return Err(format!("`{name}` has changed since ({changes}): measure it anew"));
            }
            let names: Vec<&str> = self.scenes.iter().map(|old| old.scene.as_str()).collect();
            return Err(format!("it has not measured `{name}`: its scenes are {}", names.join(", ")));
        }
        let has = |engine: &Engine| self.results.iter().any(|old| old.is_of(engine.lanes, engine.threads));
        match engines.iter().any(has) {
            true => Ok(()),
            false => Err("it has none of the widths and threads here: give --lanes or --threads".into()),
        }
    }

    /// Why the ratios may not hold, and which there are not.
    pub fn warnings(
        &self,
        settings: &RunSettings,
        engines: &[Engine],
        scenes: &[MeasuredScene],
    ) -> Vec<String> {
        let [old, new] =
            [&self.settings, settings].map(|run| Machine { commit: String::new(), ..run.machine.clone() });
        let machine = (old != new).then(|| {
            format!("the baseline is of another machine or build: {} ({})", self.settings.machine, old.flags)
        });
        let busy = (!self.reliable).then(|| "the baseline was not reliable when it was measured".to_owned());
        let is_left_out = |old: &&MeasuredScene| scenes.iter().all(|new| !old.is_same(new));
        let lacking = self.scenes.iter().filter(is_left_out).map(|old| old.scene.clone());
        let is_left_out = |old: &&Speed| engines.iter().all(|new| !old.is_of(new.lanes, new.threads));
        let others = self.results.iter().take(self.engines()).filter(is_left_out);
        let lacking: Vec<_> = lacking.chain(others.map(|old| engine_name(old.lanes, old.threads))).collect();
        let lacking = (!lacking.is_empty()).then(|| format!("only the baseline has {}", lacking.join("; ")));
        machine.into_iter().chain(busy).chain(lacking).map(|warning| warning + ".").collect()
    }

    /// The number of engines of each scene.
    fn engines(&self) -> usize {
        (self.results.len() / self.scenes.len().max(1)).max(1)
    }

    /// The ratios of all engines of a new report that the baseline has.
    pub fn ratios(&self, report: &Report) -> Vec<OverBaseline> {
        let mut ratios = Vec::new();
        for (scene, results) in report.scenes.iter().zip(report.engines()) {
            let of_scene = self.scenes.iter().zip(self.results.chunks(self.engines()));
            let olds = of_scene.filter(|(old, _)| old.is_same(scene)).map(|(_, olds)| olds).next();
            for new in results {
                let old = olds.into_iter().flatten().find(|old| old.is_of(new.lanes, new.threads));
                ratios.extend(old.map(|old| OverBaseline {
                    scene: scene.scene.clone(),
                    lanes: new.lanes,
                    threads: new.threads,
                    ratio: Ratio {
                        median: new.fps_median / old.fps_median,
                        spread: [
                            new.fps_spread[0] / old.fps_spread[1],
                            new.fps_spread[1] / old.fps_spread[0],
                        ],
                        rounds: 1,
                        reliability: new.reliability,
                    },
                }));
            }
        }
        ratios
    }

    /// The ratios as a table.
    pub fn text(&self, report: &Report) -> String {
        let ratios = report.over_baseline.as_deref().unwrap_or_default();
        let doubt = if_doubtful(self.reliable && report.reliable, "ratios");
        let meaning = format!(
            "New over old, frames per second (old: commit {}): of the median frames, and in brackets from the \
             slow tenth of the new over the fast tenth of the old to the reverse.{doubt}",
            self.settings.machine.commit
        );
        let rows = ratios.iter().map(|one| {
            let engine = engine_name(one.lanes, one.threads);
            row(&[-24, -24, 24], [one.scene.clone(), engine, ratio(one.ratio)])
        });
        format!("\n{}{}", paragraph(&meaning), rows.collect::<String>())
    }
}
