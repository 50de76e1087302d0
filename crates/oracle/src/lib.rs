//! (doc head to come)
