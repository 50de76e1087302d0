//! Tables as numbers, from which the same tables are made.

use super::super::albedo::Azimuths;
use super::super::table_store::Table;
use super::*;
use etalon_scene::Microfacets;

/// Whether what is made of a table's numbers has the same, and nothing is made of more or fewer.
fn survives<T: Table>(what: &str, table: &T, facets: &Distribution) {
    let bits = |table: &T| table.to_numbers().into_iter().map(f64::to_bits).collect::<Vec<u64>>();
    let numbers = table.to_numbers();
    let again = T::from_numbers(&numbers, facets).expect("they are its own");
    assert_eq!(bits(table), bits(&again), "{what}");
    assert!(T::from_numbers(&[], facets).is_none(), "{what}: nothing");
    assert!(T::from_numbers(&numbers[1..], facets).is_none(), "{what}: one fewer");
    assert!(T::from_numbers(&[&numbers[..], &[0.5]].concat(), facets).is_none(), "{what}: one more");
}

#[test]
fn tables_survive_as_numbers() {
    let brushed = Microfacets { alpha: [0.1, 0.4], ..Microfacets::from(0.1) };
    for facets in [ggx(0.3), Distribution::new(&brushed)] {
        let azimuths = Azimuths::of(&facets);
        for eta in [[1.5, 1.5], [1.4, 1.8]] {
            let lost = |wo: Vec3<f64>, eta: f64| 0.1 * eta * (1.0 - wo.z) * (1.0 + 0.3 * wo.x);
            let table = LossTable::new(azimuths, eta, MEAN_ERROR, lost);
            survives("losses", &table, &facets);
            let again = LossTable::from_numbers(&table.to_numbers(), &facets).expect("they are its own");
            for (mu, x) in [(0.03_f64, 0.2_f64), (0.4, 0.7), (0.99, 0.1)] {
                let sin = ((1.0 - mu) * (1.0 + mu)).sqrt();
                let w = Vec3::new(sin * x, sin * (1.0 - x * x).sqrt(), mu);
                let of = |table: &LossTable| [table.eval(w, 1.5), table.average(1.5), table.density(mu)];
                assert_eq!(of(&table), of(&again), "{eta:?}, cosine {mu}");
                assert_eq!(table.sample([mu, x]).z, again.sample([mu, x]).z);
            }
            let polarised = PolarisedLoss::new(eta, &facets, |facet, eta| polarised_loss(&facets, facet, eta));
            survives("polarised losses", &polarised, &facets);
            let again = PolarisedLoss::from_numbers(&polarised.to_numbers(), &facets).expect("they are its own");
            let w = Vec3::new(0.48, 0.36, 0.8);
            assert_eq!(polarised.eval(w, 1.45), again.eval(w, 1.45));
        }
    }
}
