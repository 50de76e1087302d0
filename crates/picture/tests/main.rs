//! Files of pictures, right and broken.

mod exr_round_trip;
mod limits;
