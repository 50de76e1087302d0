//! What a file says about the error of its picture.

use crate::{Attribute, Attributes};

/// The prefix of channels that hold the standard error of the mean of another: `Error.R` is that of `R`.
pub const ERROR_PREFIX: &str = "Error.";

/// The error of a whole picture, from the scatter of independent replicates.
///
/// The attributes are `replicates` (int), `relativeRmse` (float), `relativeRmseInterval` (v2f, 95 %), `noisiestTile` (string,
/// `X0,X1,Y0,Y1` in pixels of the frame) and, with four replicates or more, `tailIndex` (float). Infinity stands for what is unknown; a
/// picture whose error is unknown has no `noisiestTile`.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorInfo {
    /// Independent replicates of each pixel.
    pub replicates: u32,
    /// Most pixels whose errors have a part in common, because they share paths: 1 if none do.
    pub correlated_pixels: u32,
    /// Root mean square over all pixels of the standard error of Y, in units of the mean Y; infinite if unknown.
    pub relative_rmse: f64,
    /// 95 % confidence interval of `relative_rmse`; 0 to infinity if unknown.
    pub interval: [f64; 2],
    /// 0 if the replicates are distributed normally, 1 if each pixel's error is a single outlier.
    pub tail_index: Option<f64>,
    /// The tile with the largest error, if that is known: columns x0 to x1, rows y0 to y1.
    pub noisiest_tile: Option<[u32; 4]>,
}

impl ErrorInfo {
    /// The attributes that say so, numbers rounded to `f32`.
    #[must_use]
    pub fn attributes(&self) -> Attributes {
        let mut attributes = Attributes::from([
            // A u32 beyond i32 could not have been rendered.
            ("replicates".to_owned(), Attribute::Int(i32::try_from(self.replicates).unwrap_or(i32::MAX))),
            ("relativeRmse".to_owned(), Attribute::Float(self.relative_rmse as f32)),
            ("relativeRmseInterval".to_owned(), Attribute::Vec2(self.interval.map(|v| v as f32))),
        ]);
        if let Some(tile) = self.noisiest_tile {
            let tile = tile.map(|side| side.to_string()).join(",");
            attributes.insert("noisiestTile".to_owned(), Attribute::Text(tile));
        }
        if self.correlated_pixels > 1 {
            let pixels = i32::try_from(self.correlated_pixels).unwrap_or(i32::MAX);
            attributes.insert("correlatedPixels".to_owned(), Attribute::Int(pixels));
        }
        if let Some(index) = self.tail_index {
            attributes.insert("tailIndex".to_owned(), Attribute::Float(index as f32));
        }
        attributes
    }

    /// What a file's attributes say, if they say it.
    #[must_use]
    pub fn from_attributes(attributes: &Attributes) -> Option<Self> {
        let float = |name: &str| match attributes.get(name) {
            Some(Attribute::Float(value)) => Some(f64::from(*value)),
            _ => None,
        };
        let Some(Attribute::Int(replicates)) = attributes.get("replicates") else { return None };
        let Some(Attribute::Vec2(interval)) = attributes.get("relativeRmseInterval") else { return None };
        let noisiest_tile = match attributes.get("noisiestTile") {
            Some(Attribute::Text(tile)) => {
                let sides: Option<Vec<u32>> = tile.split(',').map(|side| side.parse().ok()).collect();
                Some(sides?.try_into().ok()?)
            }
            _ => None,
        };
        Some(Self {
            replicates: u32::try_from(*replicates).ok()?,
            correlated_pixels: match attributes.get("correlatedPixels") {
                Some(Attribute::Int(pixels)) => u32::try_from(*pixels).ok()?,
                _ => 1,
            },
            relative_rmse: float("relativeRmse")?,
            interval: interval.map(f64::from),
            tail_index: float("tailIndex"),
            noisiest_tile,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_attributes_say_is_read_back() {
        for (tail_index, correlated_pixels) in [(None, 1), (Some(0.25), 8)] {
            let info = ErrorInfo {
                replicates: 4,
                correlated_pixels,
                relative_rmse: 0.5,
                interval: [0.25, 1.0],
                tail_index,
                noisiest_tile: Some([16, 32, 0, 7]),
            };
            assert_eq!(ErrorInfo::from_attributes(&info.attributes()), Some(info.clone()));
            let (relative_rmse, interval) = (f64::INFINITY, [0.0, f64::INFINITY]);
            let unknown = ErrorInfo { relative_rmse, interval, noisiest_tile: None, ..info };
            assert_eq!(ErrorInfo::from_attributes(&unknown.attributes()), Some(unknown));
        }
        assert_eq!(ErrorInfo::from_attributes(&Attributes::new()), None);
    }
}
