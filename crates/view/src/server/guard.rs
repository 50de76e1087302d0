//! Who may ask: the token in the address, and pages of this server alone.

use std::net::IpAddr;

use axum::http::{HeaderMap, Method, StatusCode, header};

/// Bytes of a token of ours: 128 bits.
const TOKEN_BYTES: usize = 16;
/// Shortest token that may be given.
pub const LEAST_TOKEN: usize = 16;

/// A word in the address that nobody can guess. Who does not know it gets nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Token(String);

impl Token {
    /// A random one.
    ///
    /// # Errors
    /// If the system has no random numbers.
    pub fn random() -> Result<Self, String> {
        let mut bytes = [0; TOKEN_BYTES];
        getrandom::fill(&mut bytes).map_err(|error| format!("the system gives no random numbers: {error}"))?;
        Ok(Self(bytes.iter().map(|byte| format!("{byte:02x}")).collect()))
    }

    /// A token of somebody's own.
    ///
    /// # Errors
    /// A sentence that says what a token is, if this is none.
    pub fn new(text: &str) -> Result<Self, String> {
        let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        if text.len() >= LEAST_TOKEN && text.len() <= 128 && text.chars().all(is_plain) {
            Ok(Self(text.to_owned()))
        } else {
            Err(format!("a token has {LEAST_TOKEN} to 128 characters, each a letter, a digit, `-` or `_`"))
        }
    }

    /// The token.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// Whether a text is the token. It takes as long for every text of its length.
    pub(crate) fn is(&self, text: &str) -> bool {
        let same_length = text.len() == self.0.len();
        let different = text.bytes().zip(self.0.bytes()).fold(0, |all, (a, b)| all | (a ^ b));
        same_length && different == 0
    }
}

/// Refuses a request that does not come from a page of this server, or not from whom the token was given to.
///
/// - `Host` must be an address or `localhost`, never another name. A name can be made to lead here by whoever owns it (DNS rebinding); an
///   address cannot.
/// - `Origin`, where a browser sends one, must be this very server. `Sec-Fetch-Site` may not say that another site asks.
/// - What changes something must say that it is JSON, which a form of another site cannot.
///
/// # Errors
/// The status and a sentence.
pub(crate) fn check(
    method: &Method,
    path: &str,
    headers: &HeaderMap,
    token: &Token,
) -> Result<(), (StatusCode, String)> {
    let refuse = |status, text: &str| Err((status, text.to_owned()));
    let host = headers.get(header::HOST).and_then(|host| host.to_str().ok());
    let Some(host) = host.filter(|host| is_address(host)) else {
        return refuse(
            StatusCode::MISDIRECTED_REQUEST,
            "open this page by the IP address of its machine or as localhost: host names are refused",
        );
    };
    if let Some(origin) = headers.get(header::ORIGIN)
        && origin.to_str().ok().and_then(|origin| origin.strip_prefix("http://")) != Some(host)
    {
        return refuse(StatusCode::FORBIDDEN, "a page of another origin asks");
    }
    let site = headers.get("sec-fetch-site").and_then(|site| site.to_str().ok());
    if matches!(site, Some("cross-site" | "same-site")) && path != "/" {
        // Following a link to the page is fine; asking from within another site is not.
        let navigates = headers.get("sec-fetch-mode").is_some_and(|mode| mode == "navigate");
        if !(navigates && method == Method::GET) {
            return refuse(StatusCode::FORBIDDEN, "another site asks");
        }
    }
    let given = path.strip_prefix('/').and_then(|rest| rest.split('/').next()).unwrap_or_default();
    if !token.is(given) {
        return refuse(
            StatusCode::FORBIDDEN,
            "the address lacks the token: open the whole address that `etalon view` printed",
        );
    }
    let is_json = || headers.get(header::CONTENT_TYPE).is_some_and(|kind| kind == "application/json");
    if method == Method::POST && !is_json() {
        return refuse(StatusCode::UNSUPPORTED_MEDIA_TYPE, "what is sent here is application/json");
    }
    if method != Method::GET && method != Method::POST {
        return refuse(StatusCode::METHOD_NOT_ALLOWED, "only GET and POST are known here");
    }
    Ok(())
}

/// Whether a `Host` is an address or `localhost`, with or without a port.
fn is_address(host: &str) -> bool {
    let name = if let Some(rest) = host.strip_prefix('[') {
        match rest.split_once(']') {
            Some((name, port)) if port.is_empty() || is_port(port.strip_prefix(':')) => name,
            _ => return false,
        }
    } else {
        match host.split_once(':') {
            Some((name, port)) if is_port(Some(port)) => name,
            Some(_) => return false,
            None => host,
        }
    };
    name.eq_ignore_ascii_case("localhost") || name.parse::<IpAddr>().is_ok()
}

fn is_port(text: Option<&str>) -> bool {
    text.is_some_and(|text| text.parse::<u16>().is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::http::HeaderValue;

    fn token() -> Token {
        Token::new("0123456789abcdef").unwrap()
    }

    fn ask(method: Method, path: &str, headers: &[(&'static str, &str)]) -> Result<(), StatusCode> {
        let headers =
            headers.iter().map(|(name, value)| (name.parse().unwrap(), HeaderValue::from_str(value).unwrap()));
        check(&method, path, &headers.collect(), &token()).map_err(|(status, _)| status)
    }

    const PAGE: &str = "/0123456789abcdef/";
    const HOST: (&str, &str) = ("host", "127.0.0.1:8420");

    #[test]
    fn only_the_token_opens() {
        assert_eq!(ask(Method::GET, PAGE, &[HOST]), Ok(()));
        for path in ["/", "/0123456789abcdee/", "/0123456789abcdef0/", "//", "/x/0123456789abcdef/"] {
            assert_eq!(ask(Method::GET, path, &[HOST]), Err(StatusCode::FORBIDDEN), "{path}");
        }
        let (a, b) = (Token::random().unwrap(), Token::random().unwrap());
        assert!(a != b && a.as_str().len() == 32 && Token::new(a.as_str()).is_ok());
        for text in ["", "short", "0123456789abcde/", "0123456789 bcdef"] {
            assert!(Token::new(text).is_err(), "{text}");
        }
    }

    #[test]
    fn other_names_of_this_machine_are_refused() {
        for host in ["127.0.0.1:8420", "localhost", "LOCALHOST:9", "[::1]:8420", "[::1]", "192.0.2.7:80"] {
            assert_eq!(ask(Method::GET, PAGE, &[("host", host)]), Ok(()), "{host}");
        }
        for host in
            ["example.org", "localhost.example.org:8420", "127.0.0.1.example.org", "", "127.0.0.1:x", "[::1", "[::1]x"]
        {
            assert_eq!(ask(Method::GET, PAGE, &[("host", host)]), Err(StatusCode::MISDIRECTED_REQUEST), "{host}");
        }
        assert_eq!(ask(Method::GET, PAGE, &[]), Err(StatusCode::MISDIRECTED_REQUEST));
    }

    #[test]
    fn other_origins_and_sites_are_refused() {
        let json = ("content-type", "application/json");
        let post = |origin| ask(Method::POST, PAGE, &[HOST, json, ("origin", origin)]);
        assert_eq!(post("http://127.0.0.1:8420"), Ok(()));
        for origin in ["http://127.0.0.1:8421", "https://127.0.0.1:8420", "http://example.org", "null"] {
            assert_eq!(post(origin), Err(StatusCode::FORBIDDEN), "{origin}");
        }
        let site = |site, mode| ask(Method::GET, PAGE, &[HOST, ("sec-fetch-site", site), ("sec-fetch-mode", mode)]);
        assert_eq!(site("same-origin", "cors"), Ok(()));
        assert_eq!(site("none", "navigate"), Ok(()));
        assert_eq!(site("cross-site", "navigate"), Ok(()));
        assert_eq!(site("cross-site", "no-cors"), Err(StatusCode::FORBIDDEN));
        assert_eq!(ask(Method::POST, PAGE, &[HOST]), Err(StatusCode::UNSUPPORTED_MEDIA_TYPE));
        assert_eq!(ask(Method::PUT, PAGE, &[HOST, json]), Err(StatusCode::METHOD_NOT_ALLOWED));
    }
}
