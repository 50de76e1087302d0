//! The server: one page and what it asks for, for whoever knows the token.

pub(crate) mod answers;
pub(crate) mod guard;
pub(crate) mod page;
pub(crate) mod routes;

use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};
use std::sync::Arc;
use std::time::Duration;

use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::TcpListener;
use tokio::sync::Semaphore;

use guard::Token;
use routes::App;

/// Connections at once. A page holds one for events and some for pictures.
pub(crate) const MOST_CONNECTIONS: usize = 64;
/// Pages that look on at once.
pub(crate) const MOST_PAGES: usize = 16;
/// Bytes of what a page sends.
pub(crate) const MOST_BODY: usize = 16 << 10;
/// Bytes of the head of a request.
const MOST_HEAD: usize = 16 << 10;
/// How long a client may take to send the head of a request.
const HEAD_TIME: Duration = Duration::from_secs(10);

/// Answers requests as long as the program runs.
pub(crate) async fn run(listener: TcpListener, app: Arc<App>) -> std::io::Result<()> {
    let router = routes::router(app);
    let places = Arc::new(Semaphore::new(MOST_CONNECTIONS));
    loop {
        let (stream, _) = match listener.accept().await {
            Ok(accepted) => accepted,
            Err(_) => {
                // Such as no more file descriptors: others may be free soon.
                tokio::time::sleep(Duration::from_millis(100)).await;
                continue;
            }
        };
        // Who finds no place is sent away at once, so that those who have one are served.
        let Ok(place) = Arc::clone(&places).try_acquire_owned() else { continue };
        let service = TowerToHyperService::new(router.clone());
        tokio::spawn(async move {
            let mut server = http1::Builder::new();
            server.timer(TokioTimer::new()).header_read_timeout(HEAD_TIME).max_buf_size(MOST_HEAD);
            // A connection that breaks is no news: its page asks again.
            let _ = server.serve_connection(TokioIo::new(stream), service).await;
            drop(place);
        });
    }
}

/// The address that a browser on this machine opens. Where the server listens at every address, it is that of the machine itself.
pub(crate) fn address_of(bound: SocketAddr, token: &Token) -> String {
    let ip: IpAddr = match bound.ip() {
        IpAddr::V4(ip) if ip.is_unspecified() => Ipv4Addr::LOCALHOST.into(),
        IpAddr::V6(ip) if ip.is_unspecified() => Ipv6Addr::LOCALHOST.into(),
        ip => ip,
    };
    format!("http://{}/{}/", SocketAddr::new(ip, bound.port()), token.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_printed_address_can_be_opened_on_this_machine() {
        let token = Token::new("0123456789abcdef").expect("a valid token");
        for (bound, host) in [
            ("127.0.0.1:80", "127.0.0.1:80"),
            ("0.0.0.0:8420", "127.0.0.1:8420"),
            ("[::]:8420", "[::1]:8420"),
            ("192.0.2.7:8420", "192.0.2.7:8420"),
        ] {
            let address = address_of(bound.parse().expect("an address"), &token);
            assert_eq!(address, format!("http://{host}/0123456789abcdef/"));
        }
    }
}
