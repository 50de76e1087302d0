//! `etalon render`: a scene in, a picture out.
