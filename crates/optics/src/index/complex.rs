//! Complex refractive indices of metals.

use super::{Fit, OutsideFit, same_name};
use crate::error::{INDEX_RANGE, OpticsError, increasing, index, non_negative};
use crate::table::{lerp, locate, parse_csv};

/// Published tables: name, symbol, file.
const METALS: [(&str, &str, &str); 4] = [
    ("silver", "Ag", include_str!("../../data/metals/ag-johnson-christy-1972.csv")),
    ("gold", "Au", include_str!("../../data/metals/au-johnson-christy-1972.csv")),
    ("copper", "Cu", include_str!("../../data/metals/cu-johnson-christy-1972.csv")),
    ("aluminium", "Al", include_str!("../../data/metals/al-rakic-1995.csv")),
];

/// Complex refractive index n + ik of an absorbing medium, relative to vacuum: a table over wavelength, interpolated
/// linearly. A wave decays as exp(−2πk·z/λ), k ≥ 0.
#[derive(Clone, Debug, PartialEq)]
pub struct ComplexIndex {
    name: Option<&'static str>,
    wavelengths_nm: Vec<f64>,
    n: Vec<f64>,
    k: Vec<f64>,
    fit: Fit,
}

impl ComplexIndex {
    /// A table of at least two rows at increasing wavelengths in nm, n within [`INDEX_RANGE`], k from 0 to its end.
    ///
    /// Fails if anything of that does not hold.
    pub fn tabulated(wavelengths_nm: Vec<f64>, n: Vec<f64>, k: Vec<f64>) -> Result<Self, OpticsError> {
        increasing("a complex index of refraction", &wavelengths_nm, &[n.len(), k.len()])?;
        for &v in &n {
            index("the real part of an index of refraction", v)?;
        }
        for &v in &k {
            let extinction = "an extinction coefficient";
            if non_negative(extinction, v)? > INDEX_RANGE[1] {
                return Err(OpticsError::Extreme { what: extinction, value: v });
            }
        }
        let fit = Fit::new([wavelengths_nm[0], wavelengths_nm[wavelengths_nm.len() - 1]])?;
        Ok(Self { name: None, wavelengths_nm, n, k, fit })
    }

    /// A metal by its name or chemical symbol, see [`ComplexIndex::names`]; case does not matter.
    ///
    /// Ag, Au, Cu: Johnson & Christy, Phys. Rev. B 6, 4370 (1972), 188 to 1937 nm. Al: Rakić, Appl. Opt. 34, 4755 (1995),
    /// 207 to 1000 nm. Spelled `aluminum`, it is found as well.
    pub fn named(name: &str) -> Option<Self> {
        let wanted = if same_name(name, "aluminum") { "aluminium" } else { name };
        let (_, symbol, text) =
            METALS.iter().find(|(long, symbol, _)| same_name(long, wanted) || same_name(symbol, wanted))?;
        let rows = parse_csv::<3>(text);
        let column = |c: usize| rows.iter().map(|row| row[c]).collect();
        let table = Self::tabulated(column(0), column(1), column(2)).expect("the tables of this crate are valid");
        Some(Self { name: Some(symbol), ..table })
    }

    /// The names that [`ComplexIndex::named`] knows: `Ag`, `Au`, `Cu`, `Al`.
    pub fn names() -> impl Iterator<Item = &'static str> {
        METALS.iter().map(|(_, symbol, _)| *symbol)
    }

    /// The same metal with another rule for wavelengths outside its table.
    pub fn with_outside(mut self, outside: OutsideFit) -> Self {
        self.fit.outside = outside;
        self
    }

    /// The first and the last wavelength of the table, nm.
    pub fn range_nm(&self) -> [f64; 2] {
        self.fit.range_nm
    }

    /// What holds outside [`ComplexIndex::range_nm`].
    pub fn outside(&self) -> OutsideFit {
        self.fit.outside
    }

    /// (n, k) at a wavelength in nm (in vacuum).
    ///
    /// NaN outside the table under [`OutsideFit::Error`]; [`ComplexIndex::check_range`] tells beforehand.
    #[inline]
    pub fn eval(&self, wavelength_nm: f64) -> (f64, f64) {
        match locate(&self.wavelengths_nm, self.fit.admit(wavelength_nm)) {
            Some((i, t)) => (lerp(self.n[i], self.n[i + 1], t), lerp(self.k[i], self.k[i + 1], t)),
            None => (f64::NAN, f64::NAN),
        }
    }

    /// Whether n and k depend on the wavelength.
    pub fn is_dispersive(&self) -> bool {
        let varies = |column: &[f64]| column.iter().any(|&v| v != column[0]);
        varies(&self.n) || varies(&self.k)
    }

    /// Checks that n and k are known all over a closed range in nm.
    ///
    /// Fails with [`OpticsError::OutsideFit`] where the table does not cover the range and does not clamp.
    pub fn check_range(&self, range_nm: [f64; 2]) -> Result<(), OpticsError> {
        self.fit.check(|| self.name.unwrap_or("this complex index of refraction").to_owned(), range_nm)
    }
}
