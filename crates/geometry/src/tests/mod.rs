//! Tests of the whole: the tree against brute force, watertightness, spheres, slabs, and rays that leave surfaces.

mod brute_force;
mod builders;
mod cylinders;
mod flat;
mod flattened;
mod frames;
mod instance_nodes;
mod instances;
mod motion;
mod oracle;
mod passed;
mod placements;
mod samplers;
mod spawn;
mod spheres;
mod tree;
mod watertight;
