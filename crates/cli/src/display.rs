//! A live view: tiles are streamed to tev (<https://github.com/Tom94/tev>) while they are rendered.

use std::net::{TcpStream, ToSocketAddrs};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::thread::JoinHandle;
use std::time::Duration;

use etalon_transport::{Film, PixelRect, TileSums};
use miette::{Severity, miette};
use tev_client::{PacketCreateImage, PacketUpdateImage, TevClient};

use crate::print;

/// Where tev listens unless it is told otherwise.
pub(crate) const DEFAULT: &str = "127.0.0.1:14158";

/// A viewer that does not answer within this time is none.
const PATIENCE: Duration = Duration::from_secs(2);
/// Tiles that may wait for a slow viewer; more are left out until the next whole picture.
const WAITING: usize = 1024;
const CHANNELS: [&str; 3] = ["R", "G", "B"];

/// A rectangle of linear Rec. 709 pixels, row by row.
struct Piece {
    rect: PixelRect,
    pixels: Vec<f32>,
}

impl Piece {
    fn of(film: &Film, rect: PixelRect) -> Self {
        Self { rect, pixels: rect.pixels().flat_map(|(x, y)| film.pixel(x, y).linear_rec709()).collect() }
    }
}

/// A connection to a viewer. Tiles go out from a thread of their own: no render waits for a viewer.
pub(crate) struct Display {
    sender: Option<SyncSender<Piece>>,
    thread: Option<JoinHandle<()>>,
    replicates: u32,
    /// Whether some tile was left out.
    behind: AtomicBool,
}

impl Display {
    /// Connects, and shows a black picture under this name. Without a viewer a warning is all that comes of it.
    pub(crate) fn open(address: &str, name: &str, size: [u32; 2], replicates: u32) -> Option<Self> {
        let warn = |why: String| {
            print::warnings(&[miette!(
                severity = Severity::Warning,
                code = "no-display",
                help = "tev listens at 127.0.0.1:14158 by default",
                "there is no display server at {address}: {why}; the render goes on without"
            )]);
        };
        let mut client = match connect(address) {
            Ok(socket) => TevClient::wrap(socket),
            Err(error) => {
                warn(error.to_string());
                return None;
            }
        };
        let [width, height] = size;
        let create = PacketCreateImage { image_name: name, grab_focus: true, width, height, channel_names: &CHANNELS };
        if let Err(error) = client.send(create) {
            warn(error.to_string());
            return None;
        }
        let (sender, pieces) = sync_channel(WAITING);
        let (name, address) = (name.to_owned(), address.to_owned());
        let thread = std::thread::spawn(move || send_all(client, &name, &address, &pieces));
        Some(Self { sender: Some(sender), thread: Some(thread), replicates, behind: AtomicBool::new(false) })
    }

    /// Shows a tile, unless the viewer is behind.
    pub(crate) fn tile(&self, rect: PixelRect, sums: &TileSums) {
        let pixels = sums.pixels(self.replicates).flat_map(|pixel| pixel.linear_rec709()).collect();
        self.send(Piece { rect, pixels });
    }

    /// Shows what the viewer has missed, unless it is still behind.
    pub(crate) fn catch_up(&self, film: &Film, rect: PixelRect) {
        if self.behind.swap(false, Ordering::Relaxed) {
            self.send(Piece::of(film, rect));
        }
    }

    /// Shows what the viewer has missed, and waits for it to take that.
    pub(crate) fn finish(&self, film: &Film, rect: PixelRect) {
        if let Some(sender) = self.sender.as_ref().filter(|_| self.behind.swap(false, Ordering::Relaxed)) {
            // The thread has gone only if it panicked.
            let _ = sender.send(Piece::of(film, rect));
        }
    }

    fn send(&self, piece: Piece) {
        let sent = self.sender.as_ref().map(|sender| sender.try_send(piece));
        if let Some(Err(TrySendError::Full(_))) = sent {
            self.behind.store(true, Ordering::Relaxed);
        }
    }
}

impl Drop for Display {
    /// Waits until the viewer has everything, or has gone.
    fn drop(&mut self) {
        self.sender = None;
        if let Some(thread) = self.thread.take() {
            // It has said what was wrong itself.
            let _ = thread.join();
        }
    }
}

fn connect(address: &str) -> std::io::Result<TcpStream> {
    let mut last = std::io::Error::other("the address names no host and port");
    for socket in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&socket, PATIENCE) {
            Ok(stream) => {
                stream.set_write_timeout(Some(PATIENCE))?;
                return Ok(stream);
            }
            Err(error) => last = error,
        }
    }
    Err(last)
}

/// Sends pieces as they come. After the first that cannot be sent, the rest are thrown away.
fn send_all(mut client: TevClient, name: &str, address: &str, pieces: &Receiver<Piece>) {
    let mut lost = false;
    for Piece { rect, pixels } in pieces {
        if lost {
            continue;
        }
        let update = PacketUpdateImage {
            image_name: name,
            grab_focus: false,
            channel_names: &CHANNELS,
            channel_offsets: &[0, 1, 2],
            channel_strides: &[3, 3, 3],
            x: rect.x0,
            y: rect.y0,
            width: rect.x1 - rect.x0,
            height: rect.y1 - rect.y0,
            data: &pixels,
        };
        if let Err(error) = client.send(update) {
            lost = true;
            print::warnings(&[miette!(
                severity = Severity::Warning,
                code = "display-lost",
                "the display server at {address} is lost: {error}; the render goes on without"
            )]);
        }
    }
}
