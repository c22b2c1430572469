//! The part of HTTP/1.1 that a page needs: requests without a body, or with one of a known length
//! (RFC 9112). All else is refused.

use std::io::{self, Read, Write};
use std::time::{Duration, Instant};

/// The most bytes of a request's head.
const MOST_HEAD: usize = 16 << 10;
/// The most bytes of a request's body.
const MOST_BODY: usize = 64 << 10;
/// The most header fields.
const MOST_HEADERS: usize = 48;

/// The method of a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Method {
    Get,
    Post,
}

/// A request, read to its end.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Request {
    pub(super) method: Method,
    /// The target as it stands in the request.
    pub(super) path: String,
    /// Names in small letters, and values.
    headers: Vec<(String, String)>,
    pub(super) body: Vec<u8>,
}

impl Request {
    /// The value of a header; `None` where there is none, or more than one.
    pub(super) fn header(&self, name: &str) -> Option<&str> {
        let mut values = self.headers.iter().filter(|(known, _)| known == name);
        let (_, value) = values.next()?;
        values.next().is_none().then_some(value)
    }

    /// Whether there is a header of that name.
    pub(super) fn has_header(&self, name: &str) -> bool {
        self.headers.iter().any(|(known, _)| known == name)
    }

    fn is_last(&self) -> bool {
        self.header("connection").is_some_and(|value| value.eq_ignore_ascii_case("close"))
    }
}

/// The reason why there is no request.
#[derive(Debug)]
pub(super) enum Refusal {
    /// The other side is gone, or said nothing for too long.
    Gone,
    /// The request is answered with this status, and the connection ends.
    Status(Status),
}

impl From<io::Error> for Refusal {
    fn from(_: io::Error) -> Self {
        Self::Gone
    }
}

/// A number and its words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Status(pub(super) u16, pub(super) &'static str);

impl Status {
    pub(super) const OK: Self = Self(200, "OK");
    pub(super) const BAD_REQUEST: Self = Self(400, "Bad Request");
    pub(super) const FORBIDDEN: Self = Self(403, "Forbidden");
    pub(super) const NOT_FOUND: Self = Self(404, "Not Found");
    pub(super) const NOT_ALLOWED: Self = Self(405, "Method Not Allowed");
    pub(super) const SUPERSEDED: Self = Self(409, "Conflict");
    pub(super) const LENGTH_REQUIRED: Self = Self(411, "Length Required");
    pub(super) const TOO_LARGE: Self = Self(413, "Content Too Large");
    pub(super) const HEAD_TOO_LARGE: Self = Self(431, "Request Header Fields Too Large");
    pub(super) const NOT_IMPLEMENTED: Self = Self(501, "Not Implemented");
    pub(super) const BUSY: Self = Self(503, "Service Unavailable");
    pub(super) const VERSION: Self = Self(505, "HTTP Version Not Supported");
}

/// Reads requests one after the other.
#[derive(Debug)]
pub(super) struct Reader<R> {
    from: R,
    /// The bytes that were read and are not used yet.
    known: Vec<u8>,
    /// A request takes no longer than this from its first byte to its last.
    most: Duration,
}

impl<R: Read> Reader<R> {
    pub(super) fn new(from: R, most: Duration) -> Self {
        Self { from, known: Vec::new(), most }
    }

    /// The next request, and whether it is the last of its connection.
    pub(super) fn next(&mut self) -> Result<(Request, bool), Refusal> {
        let mut begun = None;
        let (mut request, head) = loop {
            match parse(&self.known) {
                Ok(Some(parsed)) => break parsed,
                Ok(None) if self.known.len() >= MOST_HEAD => {
                    return Err(Refusal::Status(Status::HEAD_TOO_LARGE));
                }
                Ok(None) => self.read_some(&mut begun)?,
                Err(status) => return Err(Refusal::Status(status)),
            }
        };
        let length = body_length(&request).map_err(Refusal::Status)?;
        while self.known.len() < head + length {
            self.read_some(&mut begun)?;
        }
        request.body = self.known[head..head + length].to_vec();
        self.known.drain(..head + length);
        let is_last = request.is_last();
        Ok((request, is_last))
    }

    fn read_some(&mut self, begun: &mut Option<Instant>) -> Result<(), Refusal> {
        let mut more = [0; 4096];
        let count = self.from.read(&mut more)?;
        self.known.extend(&more[..count]);
        let is_late = begun.get_or_insert_with(Instant::now).elapsed() > self.most;
        if count == 0 || is_late {
            return Err(Refusal::Gone);
        }
        Ok(())
    }
}

/// A request without its body, and the length of its head; `None` where that is not all there.
fn parse(bytes: &[u8]) -> Result<Option<(Request, usize)>, Status> {
    let mut headers = [httparse::EMPTY_HEADER; MOST_HEADERS];
    let mut parsed = httparse::Request::new(&mut headers);
    let length = match parsed.parse(bytes) {
        Ok(httparse::Status::Complete(length)) if length <= MOST_HEAD => length,
        Ok(httparse::Status::Complete(_)) | Err(httparse::Error::TooManyHeaders) => {
            return Err(Status::HEAD_TOO_LARGE);
        }
        Ok(httparse::Status::Partial) => return Ok(None),
        Err(httparse::Error::Version) => return Err(Status::VERSION),
        Err(_) => return Err(Status::BAD_REQUEST),
    };
    if parsed.version != Some(1) {
        return Err(Status::VERSION);
    }
    let method = match parsed.method {
        Some("GET") => Method::Get,
        Some("POST") => Method::Post,
        _ => return Err(Status::NOT_ALLOWED),
    };
    let text = |value: &[u8]| std::str::from_utf8(value).map(str::to_owned);
    let headers = parsed.headers.iter().map(|header| {
        let value = text(header.value).map_err(|_| Status::BAD_REQUEST)?;
        Ok((header.name.to_ascii_lowercase(), value))
    });
    let request = Request {
        method,
        path: parsed.path.unwrap_or_default().to_owned(),
        headers: headers.collect::<Result<_, Status>>()?,
        body: Vec::new(),
    };
    Ok(Some((request, length)))
}

/// The length of the body, by the only header that may say so.
fn body_length(request: &Request) -> Result<usize, Status> {
    if request.has_header("transfer-encoding") || request.has_header("expect") {
        return Err(Status::NOT_IMPLEMENTED);
    }
    if !request.has_header("content-length") {
        return match request.method {
            Method::Get => Ok(0),
            Method::Post => Err(Status::LENGTH_REQUIRED),
        };
    }
    let digits = request.header("content-length");
    let is_number =
        |digits: &&str| !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit());
    let digits = digits.filter(is_number).ok_or(Status::BAD_REQUEST)?;
    match digits.parse() {
        Ok(0) => Ok(0),
        Ok(_) if request.method == Method::Get => Err(Status::BAD_REQUEST),
        Ok(length) if length <= MOST_BODY => Ok(length),
        _ => Err(Status::TOO_LARGE),
    }
}

/// The answer to a request.
#[derive(Debug)]
pub(super) struct Response {
    pub(super) status: Status,
    pub(super) kind: &'static str,
    /// A header beside those that all have.
    pub(super) extra: Option<(&'static str, String)>,
    pub(super) body: Vec<u8>,
}

impl Response {
    pub(super) fn new(status: Status, kind: &'static str, body: impl Into<Vec<u8>>) -> Self {
        Self { status, kind, extra: None, body: body.into() }
    }

    /// A status that says nothing else.
    pub(super) fn bare(status: Status) -> Self {
        Self::new(status, "text/plain; charset=utf-8", status.1)
    }

    /// Writes it; `is_last` says that the connection ends.
    pub(super) fn write(&self, to: &mut dyn Write, is_last: bool) -> io::Result<()> {
        let Status(number, words) = self.status;
        let mut head = format!(
            "HTTP/1.1 {number} {words}\r\nContent-Type: {}\r\nContent-Length: {}\r\n{}",
            self.kind,
            self.body.len(),
            super::guard::HEADERS
        );
        if let Some((name, value)) = &self.extra {
            head.extend([name, ": ", value, "\r\n"]);
        }
        head.push_str(if is_last {
            "Connection: close\r\n\r\n"
        } else {
            "Connection: keep-alive\r\n\r\n"
        });
        to.write_all(head.as_bytes())?;
        to.write_all(&self.body)?;
        to.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "POST /probe HTTP/1.1\r\nHost: a\r\nContent-Length: 5\r\n\r\nhelloGET / HTTP/1.1\r\nHost: b\r\n\r\n";

    /// Hands on bytes in small portions.
    struct Slow<'a>(&'a [u8], usize);

    impl Read for Slow<'_> {
        fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
            let count = self.1.min(self.0.len()).min(to.len());
            to[..count].copy_from_slice(&self.0[..count]);
            self.0 = &self.0[count..];
            Ok(count)
        }
    }

    fn all(bytes: &[u8], step: usize) -> (Vec<Request>, Refusal) {
        let mut reader = Reader::new(Slow(bytes, step), Duration::from_secs(60));
        let mut requests = Vec::new();
        loop {
            match reader.next() {
                Ok((request, _)) => requests.push(request),
                Err(refusal) => return (requests, refusal),
            }
        }
    }

    #[test]
    fn requests_are_the_same_however_they_come() {
        for step in 1..GOOD.len() {
            let (requests, end) = all(GOOD.as_bytes(), step);
            let told: Vec<_> =
                requests.iter().map(|one| (one.method, &*one.path, &*one.body)).collect();
            let expected = [(Method::Post, "/probe", &b"hello"[..]), (Method::Get, "/", &[])];
            assert_eq!(told, expected, "{step}");
            assert!(matches!(end, Refusal::Gone));
        }
    }

    #[test]
    fn the_start_of_a_request_is_none() {
        let first = GOOD.find("GET").unwrap();
        for end in 0..GOOD.len() {
            let (requests, _) = all(&GOOD.as_bytes()[..end], 7);
            assert_eq!(requests.len(), usize::from(end >= first), "{end}");
        }
    }

    /// The reader ends whatever comes, and reads no more than what came.
    #[test]
    fn no_bytes_do_harm() {
        let mut state = 1_u64;
        let mut draw = |below: usize| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            usize::try_from(state >> 33).unwrap() % below
        };
        let mut read = 0;
        for _ in 0..20_000 {
            let mut bytes = GOOD.as_bytes().to_vec();
            for _ in 0..=draw(4) {
                let at = draw(bytes.len());
                match draw(4) {
                    0 => bytes[at] = u8::try_from(draw(256)).unwrap(),
                    1 => bytes.truncate(at + 1),
                    2 => drop(bytes.remove(at)),
                    _ => {
                        let again = bytes[at..].to_vec();
                        bytes.extend(again);
                    }
                }
                if bytes.is_empty() {
                    break;
                }
            }
            let (requests, _) = all(&bytes, 1 + draw(50));
            let taken: usize = requests.iter().map(|one| one.path.len() + one.body.len()).sum();
            assert!(taken <= bytes.len());
            read += requests.len();
        }
        assert!(read > 10_000, "{read}: most are still requests");
    }
}
