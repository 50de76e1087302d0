//! The live view: what is sent is what a viewer of tev's protocol reads.

use std::io::Read;
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::thread;

use crate::support::{etalon_line, pixel_bits, scene};

/// What a viewer shows after all packets.
#[derive(Default)]
struct Viewer {
    name: String,
    width: usize,
    height: usize,
    /// R, G, B of each pixel, row by row.
    pixels: Vec<[f32; 3]>,
    updates: usize,
}

/// The bytes of a packet, read front to back.
struct Packet<'a>(&'a [u8]);

impl Packet<'_> {
    fn take(&mut self, count: usize) -> &[u8] {
        let (head, rest) = self.0.split_at(count);
        self.0 = rest;
        head
    }

    fn byte(&mut self) -> u8 {
        self.take(1)[0]
    }

    fn int(&mut self) -> usize {
        u32::from_le_bytes(self.take(4).try_into().unwrap()) as usize
    }

    fn long(&mut self) -> usize {
        u64::from_le_bytes(self.take(8).try_into().unwrap()) as usize
    }

    fn float(&mut self) -> f32 {
        f32::from_le_bytes(self.take(4).try_into().unwrap())
    }

    fn string(&mut self) -> String {
        let end = self.0.iter().position(|&byte| byte == 0).expect("strings end in NUL");
        let text = String::from_utf8(self.take(end).to_vec()).unwrap();
        self.byte();
        text
    }
}

impl Viewer {
    /// Reads packets until the other side closes. Each begins with its length in bytes, itself included, then its kind: 4 creates
    /// a picture, 6 updates a part of it.
    fn watch(mut stream: TcpStream) -> Self {
        let mut viewer = Self::default();
        let mut length = [0; 4];
        while stream.read_exact(&mut length).is_ok() {
            let mut bytes = vec![0; u32::from_le_bytes(length) as usize - 4];
            stream.read_exact(&mut bytes).unwrap();
            let mut packet = Packet(&bytes);
            match packet.byte() {
                4 => viewer.create(&mut packet),
                6 => viewer.update(&mut packet),
                other => panic!("a packet of kind {other}"),
            }
            assert!(packet.0.is_empty(), "{} bytes too many", packet.0.len());
        }
        viewer
    }

    fn create(&mut self, packet: &mut Packet<'_>) {
        packet.byte();
        self.name = packet.string();
        (self.width, self.height) = (packet.int(), packet.int());
        let channels: Vec<_> = (0..packet.int()).map(|_| packet.string()).collect();
        assert_eq!(channels, ["R", "G", "B"]);
        self.pixels = vec![[0.0; 3]; self.width * self.height];
    }

    fn update(&mut self, packet: &mut Packet<'_>) {
        packet.byte();
        assert_eq!(packet.string(), self.name);
        let channels: Vec<_> = (0..packet.int()).map(|_| packet.string()).collect();
        let index = |name: &str| ["R", "G", "B"].iter().position(|known| *known == name).unwrap();
        let (x, y, width, height) = (packet.int(), packet.int(), packet.int(), packet.int());
        let offsets: Vec<_> = channels.iter().map(|_| packet.long()).collect();
        let strides: Vec<_> = channels.iter().map(|_| packet.long()).collect();
        let data: Vec<f32> = (0..packet.0.len() / 4).map(|_| packet.float()).collect();
        for pixel in 0..width * height {
            let at = (y + pixel / width) * self.width + x + pixel % width;
            for (channel, name) in channels.iter().enumerate() {
                self.pixels[at][index(name)] = data[offsets[channel] + pixel * strides[channel]];
            }
        }
        self.updates += 1;
    }
}

#[test]
fn a_viewer_sees_every_tile_and_in_the_end_the_picture() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("x.exr");
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    let viewer = thread::spawn(move || Viewer::watch(listener.accept().unwrap().0));
    // The crop's tiles are not those of the frame.
    let line = format!("render {{}} -o {{}} --size 70x40 --crop 3,1,57,39 --spp 16 --quiet --display-server={address}");
    etalon_line(&line, [&scene("cornell.json"), &output]).expect(0);
    let viewer = viewer.join().unwrap();
    assert_eq!((viewer.name.as_str(), viewer.width, viewer.height), (output.to_str().unwrap(), 70, 40));
    // Twelve tiles in three passes.
    assert_eq!(viewer.updates, 12 * 3);
    let (_, file) = pixel_bits(&output);
    for (channel, name) in ["R", "G", "B"].into_iter().enumerate() {
        let samples = file.picture.channel(name).unwrap();
        for (pixel, &sample) in samples.iter().enumerate() {
            let (x, y) = (3 + pixel % 57, 1 + pixel / 57);
            assert_eq!(viewer.pixels[y * 70 + x][channel], sample, "{name} at {x}, {y}");
        }
    }
}

#[test]
fn a_viewer_that_is_not_there_or_goes_away_does_not_stop_the_render() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("x.exr");
    let address = {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        listener.local_addr().unwrap()
    };
    let render = |address: String, path: &Path| {
        let line = format!("render {{}} -o {{}} --size 64x64 --spp 16 --json --display-server={address}");
        etalon_line(&line, [&scene("cornell.json"), path]).expect(0)
    };
    render(address.to_string(), &output).says(["no display server at", "goes on without"]);
    assert!(output.exists());
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    let viewer = thread::spawn(move || {
        let mut stream = listener.accept().unwrap().0;
        // The first packet, and no more.
        stream.read_exact(&mut [0; 16]).unwrap();
    });
    render(address.to_string(), &output).says(["is lost", "goes on without"]);
    viewer.join().unwrap();
}
