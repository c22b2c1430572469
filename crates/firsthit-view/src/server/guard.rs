//! Access checks: the server answers its own page, and no other.

use super::http::{Method, Request, Status};

/// The headers of every answer. No script from elsewhere runs in the page, no other page may frame
/// or read it, and no cache keeps it.
pub(super) const HEADERS: &str = "\
Content-Security-Policy: default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; connect-src 'self'; \
img-src 'self' blob: data:; style-src 'self'; worker-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'\r\n\
X-Content-Type-Options: nosniff\r\n\
Referrer-Policy: no-referrer\r\n\
Cache-Control: no-store\r\n\
Cross-Origin-Opener-Policy: same-origin\r\n\
Cross-Origin-Embedder-Policy: require-corp\r\n\
Cross-Origin-Resource-Policy: same-origin\r\n";

/// The name of the header that carries the token. A page elsewhere could send it only after asking,
/// and is refused then.
const TOKEN: &str = "x-firsthit-token";

/// The conditions for a request to be answered.
#[derive(Debug)]
pub(super) struct Guard {
    /// The server's port.
    port: u16,
    token: String,
}

impl Guard {
    /// A guard for a port, with a new token of 192 random bits.
    pub(super) fn new(port: u16) -> std::io::Result<Self> {
        let mut bits = [0; 24];
        getrandom::fill(&mut bits).map_err(std::io::Error::other)?;
        let digit = |four: u8| char::from(b"0123456789abcdef"[usize::from(four & 15)]);
        let token = bits.iter().flat_map(|&byte| [digit(byte >> 4), digit(byte)]).collect();
        Ok(Self { port, token })
    }

    pub(super) fn token(&self) -> &str {
        &self.token
    }

    /// Refuses requests that another page or another name of this machine may have caused, and
    /// questions without the token.
    pub(super) fn check(&self, request: &Request) -> Result<(), Status> {
        // Browsers leave out the port 80.
        let port = if self.port == 80 { String::new() } else { format!(":{}", self.port) };
        let hosts = ["127.0.0.1", "localhost"].map(|name| format!("{name}{port}"));
        // Against DNS rebinding.
        let host = request.header("host").ok_or(Status::FORBIDDEN)?;
        if !hosts.iter().any(|known| known == host) {
            return Err(Status::FORBIDDEN);
        }
        if request.has_header("origin") {
            let origin = request.header("origin").unwrap_or_default();
            if origin != format!("http://{host}") {
                return Err(Status::FORBIDDEN);
            }
        }
        if request.has_header("sec-fetch-site") {
            let site = request.header("sec-fetch-site").unwrap_or_default();
            if !["same-origin", "none"].contains(&site) {
                return Err(Status::FORBIDDEN);
            }
        }
        let is_known = |given: &str| is_same(given.as_bytes(), self.token.as_bytes());
        if request.method == Method::Post && !request.header(TOKEN).is_some_and(is_known) {
            return Err(Status::FORBIDDEN);
        }
        Ok(())
    }
}

/// Whether two texts are equal, in a time that does not tell where they differ.
fn is_same(a: &[u8], b: &[u8]) -> bool {
    a.len() == b.len() && a.iter().zip(b).fold(0, |all, (a, b)| all | (a ^ b)) == 0
}
