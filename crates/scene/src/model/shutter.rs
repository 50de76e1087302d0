//! When the shutter is open, and where everything is then.

use super::{Camera, Instance, Scene};

/// The middle of the shutter's time, s.
pub(crate) fn middle_s([open, close]: [f64; 2]) -> f64 {
    open + 0.5 * (close - open)
}

impl Scene {
    /// Opens and closes the shutter at other times, s: the camera and all instances that have keyframes are then where these put them in
    /// the middle of the time. The scene is that of a file that states these times.
    ///
    /// The times must be finite, and the first not after the second.
    pub fn set_shutter(&mut self, shutter_s: [f64; 2]) {
        self.camera.set_shutter(shutter_s);
        let grouped = self.groups.iter_mut().flat_map(|group| &mut group.instances);
        self.instances.iter_mut().chain(grouped).for_each(|instance| instance.place(shutter_s));
    }
}

impl Camera {
    /// See [`Scene::set_shutter`].
    pub(crate) fn set_shutter(&mut self, shutter_s: [f64; 2]) {
        self.shutter_s = shutter_s;
        if let Some(motion) = &self.motion {
            [self.position_m, self.forward, self.up] = motion.at(middle_s(shutter_s));
        }
    }

    /// Whether it moves while the shutter is open.
    pub fn moves(&self) -> bool {
        self.motion.as_ref().is_some_and(|motion| motion.moves(self.shutter_s))
    }
}

impl Instance {
    /// See [`Scene::set_shutter`].
    fn place(&mut self, shutter_s: [f64; 2]) {
        if let Some(motion) = &self.motion {
            self.transform = motion.at(middle_s(shutter_s));
        }
    }

    /// Whether it moves while the shutter is open.
    pub fn moves(&self, shutter_s: [f64; 2]) -> bool {
        self.motion.as_ref().is_some_and(|motion| motion.moves(shutter_s))
    }
}
