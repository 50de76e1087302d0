//! Integration tests of the program and of whole renders, in one binary.
