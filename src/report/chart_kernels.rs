//! The drawings of intersection methods in `octray chart`: cost beside failures and errors.

use super::dots::{Column, DotTable};
use super::drawing::Drawing;
use super::numbers::{figure, percent};
use crate::measure::chart::kernels::{CaseAt, EFFORT, Kernel};
use crate::wording::grouped;

/// Returns a drawing for each family of methods.
pub fn intersection(kernels: &[Kernel]) -> Vec<Drawing> {
    let mut families: Vec<&str> = kernels.iter().map(|kernel| kernel.family).collect();
    families.sort_unstable();
    families.dedup();
    let drawing =
        |family| Drawing { name: format!("kernels-{family}"), svg: of_family(family, kernels).svg() };
    families.into_iter().map(drawing).collect()
}

fn of_family(family: &str, kernels: &[Kernel]) -> DotTable {
    let of_family = || kernels.iter().filter(|kernel| kernel.family == family);
    let widest = of_family().map(|kernel| kernel.lanes).max().unwrap_or(1);
    let at = |lanes: usize| of_family().filter(move |kernel| kernel.lanes == lanes);
    let cost = |lanes: usize| {
        let default = at(lanes).find(|kernel| kernel.default).map_or(f64::NAN, |kernel| kernel.ns);
        let value = |kernel: &Kernel| Some((kernel.ns / default, format!("{:.2}×", kernel.ns / default)));
        let name = if lanes == 1 { "cost, scalar".into() } else { format!("cost, {lanes} lanes") };
        let unit = format!("1× is {} ns", figure(default, 2));
        Column { name, unit, log: false, values: at(lanes).map(value).collect() }
    };
    let log = |name: &str, value: &dyn Fn(&Kernel) -> Option<(f64, String)>| {
        let (name, unit) = (name.into(), "log scale".into());
        Column { name, unit, log: true, values: at(widest).map(value).collect() }
    };
    let Some(Kernel { failure_case, error_case, .. }) = at(widest).next() else { return DotTable::default() };
    let mut columns = vec![cost(widest)];
    columns.extend((widest > 1).then(|| cost(1)));
    columns.push(log("failures", &|kernel| Some((100.0 * kernel.failures, percent(kernel.failures)))));
    let (test_case, place) = (failure_case.test_case, grouped(failure_case.place));
    let mut notes = vec![format!(
        "Cost: one ray against one primitive, over the default's. Failures: {} of stability test case {test_case} at {place}.",
        percent(EFFORT.0)
    )];
    if let Some(CaseAt { test_case, place }) = error_case {
        let place = grouped(place);
        notes.push(format!(
            "Error: of t where no method failed, 99th percentile; test case {test_case} at {place}."
        ));
        let scientific = |p99: f64| if p99 == 0.0 { "0".into() } else { format!("{p99:.0e}") };
        columns.push(log("error of t", &|kernel| kernel.p99.map(|p99| (p99, scientific(p99)))));
    }
    let rows = at(widest).map(|kernel| (kernel.method.to_owned(), kernel.default)).collect();
    let title = format!("{family} tests: what each method costs, and where it fails");
    DotTable { title, notes, rows, columns }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costs_are_ratios_to_the_default_at_the_same_width() {
        let of = |method, lanes, ns| {
            let default = method == "padded";
            Kernel { family: "box", method, default, lanes, ns, failures: 0.125, ..Kernel::default() }
        };
        let kernels =
            [of("padded", 16, 0.5), of("naive", 16, 0.25), of("padded", 1, 4.0), of("naive", 1, 6.0)];
        let table = of_family("box", &kernels);
        let found = table.columns.iter().map(|column| {
            let values = column.values.iter().flatten().map(|(value, text)| format!("{value} {text}"));
            format!("{}: {}", column.name, values.collect::<Vec<_>>().join(", "))
        });
        let expected = [
            "cost, 16 lanes: 1 1.00×, 0.5 0.50×",
            "cost, scalar: 1 1.00×, 1.5 1.50×",
            "failures: 12.5 12 %, 12.5 12 %",
        ];
        assert_eq!(found.collect::<Vec<_>>(), expected);
    }
}
