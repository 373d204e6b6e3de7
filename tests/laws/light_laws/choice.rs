//! Which light is sampled: its probability is what its weight is divided by, by irradiance where lights are
//! few or very many.

use super::many_lamps;
use crate::common::*;
use octray::kernel::surface::{sphere_offset, triangle_offset};
use octray::primitives::{LightTable, SampledAs};
use std::collections::HashMap;

const ALL: u64 = Features::ALL.0;

#[test]
fn a_rectangular_lamp_is_one_light() {
    let cornell = load("builtin:cornell").unwrap();
    let lights = Lights::new(&cornell, LightChoice::Auto);
    assert_eq!(lights.len(), 1);
    let halves = |lights: &Lights| {
        let sampled = (0..cornell.primitives()).map(|number| lights.sampled_as(number));
        sampled.filter(|sampled| matches!(sampled, SampledAs::Half(..))).count()
    };
    assert_eq!(halves(&lights), 2);
    let by_power = Lights::new(&cornell, LightChoice::Power);
    assert_eq!((by_power.len(), halves(&by_power)), (2, 0));
    let is_lamp = |material: u32| cornell.materials[material as usize].emission != Vec3::ZERO;
    let mut bent = cornell.clone();
    for triangle in bent.triangles.iter_mut().filter(|triangle| is_lamp(triangle.material)) {
        triangle.vertices[0].z -= 0.01;
    }
    assert_eq!(Lights::new(&bent, LightChoice::Auto).len(), 2);
}

#[test]
fn few_and_many_lights_are_chosen_by_irradiance() {
    for (count, by_irradiance) in [(1, false), (2, true), (8, true), (9, false), (64, false), (65, true)] {
        // The floor is a light too.
        let scene = many_lamps(count - 1);
        let found = [LightChoice::Auto, LightChoice::Power]
            .map(|choice| Lights::new(&scene, choice))
            .map(|lights| (lights.len(), lights.are_chosen_by_irradiance()));
        assert_eq!(found, [(count, by_irradiance), (count, false)]);
    }
}

#[test]
fn compared_lights_count_once_each_and_have_points_all_over_them() {
    let (mut rng, mut checked) = (Rng(16), 0);
    for round in 0..60 {
        let count = 2 + round % 7;
        let scene = many_lamps(count - 1);
        let lights = Lights::new(&scene, LightChoice::Auto);
        let (point, n) = ((rng.in_cube() * 3.0).as_vec3(), rng.direction().as_vec3());
        const NUMBERS: u32 = 1 << 16;
        // By the light's place: how often it is drawn, its weight over its probability, the rests of u.
        let mut drawn: HashMap<[u32; 3], [f64; 3]> = HashMap::new();
        for number in 0..NUMBERS {
            let u = number as f32 / NUMBERS as f32;
            let at = (math::Vec3::splat(point), math::Vec3::splat(n));
            let (light, rest) = lights.compare::<f32, ALL>(at, u, count <= LightTable::FEW);
            assert!((0.0..1.0).contains(&rest) && light.weight >= 0.0, "{rest} {}", light.weight);
            let place = [light.at.x, light.at.y, light.at.z].map(f32::to_bits);
            let more = [1.0, f64::from(light.weight / light.probability), f64::from(rest)];
            let sums = drawn.entry(place).or_default();
            sums.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
        }
        for [drawn, weight, rest] in drawn.into_values().filter(|sums| sums[0] > 100.0 && sums[1] > 0.0) {
            let (weight, rest, error) = (weight / f64::from(NUMBERS), rest / drawn, 2.0 / drawn);
            assert!((weight - 1.0).abs() < error, "weight {weight}, drawn {drawn} times");
            assert!((rest - 0.5).abs() < error, "mean {rest}, drawn {drawn} times");
            checked += 1;
        }
    }
    assert!(checked > 100, "only {checked} lights checked");
}

#[test]
fn compared_lights_are_chosen_in_proportion_to_their_irradiance() {
    // Equal lamps straight above at 1 and 3, one with twice the power at 2 and 60° from above, one below.
    let aslant = vec3(2.0 * 0.75f32.sqrt(), 1.0, 0.0);
    let at = [(Vec3::Y, 1.0), (3.0 * Vec3::Y, 1.0), (aslant, 2.0), (-Vec3::Y, 4.0)];
    let mut scene = many_lamps(0);
    scene.materials[0].emission = Vec3::ZERO;
    for (center, power) in at {
        scene.materials.push(lamp(power));
        scene.spheres.push(sphere(center, 1e-3, scene.materials.len() as u32 - 1));
    }
    let lights = Lights::new(&scene, LightChoice::Auto);
    assert!(lights.len() == 4 && lights.are_chosen_by_irradiance());
    let irradiance = [1.0, 1.0 / 9.0, 2.0 / 4.0 * 0.5, 0.0];
    let mut drawn = [0.0; 4];
    for number in 0..10_000 {
        let above = (math::Vec3::splat(Vec3::ZERO), math::Vec3::splat(Vec3::Y));
        let (light, _) = lights.compare::<f32, ALL>(above, number as f32 / 10_000.0, true);
        let center = vec3(light.at.x, light.at.y, light.at.z);
        drawn[at.iter().position(|&(other, _)| other == center).unwrap()] += 1e-4;
    }
    let sum: f64 = irradiance.iter().sum();
    for (drawn, irradiance) in drawn.iter().zip(irradiance) {
        assert!((drawn - irradiance / sum).abs() < 0.01, "{drawn} for {}", irradiance / sum);
    }
    // From where every light is below the horizon, none counts.
    let below = (math::Vec3::splat(4.0 * Vec3::Y), math::Vec3::splat(Vec3::Y));
    assert_eq!(lights.compare::<f32, ALL>(below, 0.3, true).0.weight, 0.0);
}

/// Shadow rays end that far before them.
#[test]
fn chosen_lights_bring_the_error_bound_of_their_surface() {
    let scene = many_lamps(40);
    let lights = Lights::new(&scene, LightChoice::Power);
    let mut checked = HashMap::new();
    for number in 0..2_000 {
        let (light, _) = lights.choose_by_power::<f32>(number as f32 / 2_000.0, || 0.3, || 0.6, false);
        let at = vec3(light.at.x, light.at.y, light.at.z);
        let sphere = scene.spheres.iter().find(|sphere| sphere.center == at);
        let triangle = scene.triangles.iter().find(|triangle| triangle.vertices[0] == at);
        let bound = match (sphere, triangle) {
            (Some(sphere), _) => sphere_offset(sphere.center, sphere.radius),
            (None, Some(triangle)) => triangle_offset(triangle.vertices),
            (None, None) => continue,
        };
        assert!(bound > 0.0 && light.offset == bound, "{} for {bound}", light.offset);
        checked.insert(at.to_array().map(f32::to_bits), sphere.is_some());
    }
    let spheres = checked.values().filter(|&&sphere| sphere).count();
    assert!(spheres >= 5 && checked.len() - spheres >= 5, "{spheres} spheres of {}", checked.len());
}

#[test]
fn resampled_lights_count_once_each() {
    let scene = many_lamps(100);
    let lights = Lights::new(&scene, LightChoice::Auto);
    assert!(lights.are_chosen_by_irradiance());
    // From below, where every light is above the horizon.
    let point = vec3(0.1, -3.0, 0.2);
    let primitives = scene.primitives();
    let (mut counts, mut sums) = (vec![0.0; primitives], vec![0.0; primitives]);
    let draws = 2_000_000;
    for draw in 0..draws {
        // An additive recurrence: evener than random numbers.
        let numbers = [0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9]
            .map(|step: f64| (0.5 + step * f64::from(draw)).fract() as f32);
        let light = lights.resample::<f32>((math::Vec3::splat(point), math::Vec3::splat(Vec3::Y)), numbers);
        // Lights differ in their probabilities.
        let number = lights.probabilities.iter().position(|&p| p == light.probability).unwrap();
        counts[number] += 1.0;
        sums[number] += f64::from(light.weight / light.probability) / f64::from(draws);
    }
    let (all, mut checked) = (sums.iter().sum::<f64>() / lights.len() as f64, 0);
    // Rarely chosen ones too, each as often too much as too little.
    assert!((all - 1.0).abs() < 0.01, "{all} of all lights");
    for (number, (sum, count)) in sums.into_iter().zip(counts).enumerate() {
        let same = lights.probabilities.iter().filter(|&&p| p == lights.probabilities[number]).count();
        if count > 2000.0 && same == 1 {
            // Each light once.
            assert!((sum - 1.0).abs() < 0.15, "light {number}, drawn {count} times: {sum}");
            checked += 1;
        }
    }
    assert!(checked >= 10, "only {checked} lights checked one by one");
}
