//! The page's server over real sockets: who is answered, with what, and who is not.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::sleep;
use std::time::{Duration, Instant};

use firsthit::camera::StandardView;
use firsthit::render::framing_camera;
use firsthit::shade::Appearance;
use firsthit::{DVec3, Object, Scene, Sphere};
use firsthit_view::Viewer;
use firsthit_view::server::Server;
use serde_json::{Value, json};

/// An address as the tests see it.
#[derive(Clone, Copy)]
struct Page<'a> {
    port: u16,
    token: &'a str,
}

fn viewer() -> Viewer {
    let ball =
        Object::new(Sphere::new(DVec3::ZERO, 1.0).unwrap()).named("<img src=x onerror=alert(1)>");
    let box_beside = Object::new(Sphere::new(DVec3::new(3.0, 0.0, 0.0), 1.0).unwrap());
    let scene = Scene::new(vec![ball, box_beside]).unwrap();
    let camera = framing_camera(&scene, DVec3::Z, StandardView::Front, [48, 64]).unwrap();
    Viewer::new("two balls", scene, Appearance::default(), &camera).unwrap()
}

/// Runs a server while the test asks it.
fn served(test: impl FnOnce(Page<'_>)) {
    let server = Server::bind(viewer(), 0).unwrap();
    let address = server.address();
    let (place, token) = address.split_once("/#").unwrap();
    let port = place.strip_prefix("http://127.0.0.1:").unwrap().parse().unwrap();
    let is_stopped = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| server.run(&|| is_stopped.load(Ordering::Relaxed)));
        let outcome =
            std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| test(Page { port, token })));
        is_stopped.store(true, Ordering::Relaxed);
        if let Err(panic) = outcome {
            std::panic::resume_unwind(panic);
        }
    });
}

struct Reply {
    status: u16,
    head: String,
    body: Vec<u8>,
}

impl Reply {
    fn header(&self, name: &str) -> Option<&str> {
        let mut lines = self.head.lines().skip(1);
        lines.find_map(|line| {
            let (known, value) = line.split_once(": ")?;
            known.eq_ignore_ascii_case(name).then_some(value)
        })
    }

    fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap()
    }
}

/// The next reply of a connection.
fn read_reply(from: &mut impl Read) -> Reply {
    let mut head = Vec::new();
    while !head.ends_with(b"\r\n\r\n") {
        let mut byte = [0];
        assert_eq!(from.read(&mut byte).unwrap(), 1, "{}", String::from_utf8_lossy(&head));
        head.push(byte[0]);
    }
    let head = String::from_utf8(head).unwrap();
    let mut reply =
        Reply { status: head.split(' ').nth(1).unwrap().parse().unwrap(), head, body: Vec::new() };
    let length = reply.header("content-length").unwrap().parse().unwrap();
    reply.body.resize(length, 0);
    from.read_exact(&mut reply.body).unwrap();
    reply
}

fn raw(port: u16, request: &[u8]) -> Reply {
    let mut stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
    // It may answer, and close, before it has read all.
    let _ = stream.write_all(request);
    read_reply(&mut stream)
}

impl Page<'_> {
    /// A request with these lines in its head.
    fn ask(self, first: &str, lines: &[&str], body: &str) -> Reply {
        let mut request = format!("{first}\r\n");
        for line in lines {
            request += line;
            request += "\r\n";
        }
        raw(self.port, format!("{request}\r\n{body}").as_bytes())
    }

    fn host(self) -> String {
        format!("Host: 127.0.0.1:{}", self.port)
    }

    fn get(self, path: &str) -> Reply {
        self.ask(&format!("GET {path} HTTP/1.1"), &[&self.host()], "")
    }

    /// A question of the page itself.
    fn post(self, path: &str, body: &Value) -> Reply {
        let body = body.to_string();
        let own = [
            self.host(),
            format!("Origin: http://127.0.0.1:{}", self.port),
            format!("X-Firsthit-Token: {}", self.token),
            format!("Content-Length: {}", body.len()),
        ];
        let lines = own.each_ref().map(String::as_str);
        self.ask(&format!("POST {path} HTTP/1.1"), &lines, &body)
    }

    fn camera(self) -> Value {
        self.post("/info", &json!({})).json()["camera"].clone()
    }
}

#[test]
fn the_page_is_served_with_its_policy() {
    served(|page| {
        for path in ["/", "/app.css", "/main.js", "/engine-native.js"] {
            let reply = page.get(path);
            assert_eq!(reply.status, 200, "{path}");
            let policy = reply.header("content-security-policy").unwrap();
            assert!(policy.starts_with("default-src 'none'; script-src 'self'"), "{policy}");
            // It compiles the WebAssembly module, and no text.
            let others = policy.replace("'wasm-unsafe-eval'", "");
            assert!(!others.contains("unsafe"), "{policy}");
            for directive in [
                "frame-ancestors 'none'",
                "base-uri 'none'",
                "form-action 'none'",
                "connect-src 'self'",
            ] {
                assert!(policy.contains(directive), "{directive}");
            }
            let others = [
                ("x-content-type-options", "nosniff"),
                ("referrer-policy", "no-referrer"),
                ("cache-control", "no-store"),
                ("cross-origin-opener-policy", "same-origin"),
                ("cross-origin-embedder-policy", "require-corp"),
                ("cross-origin-resource-policy", "same-origin"),
            ];
            for (name, value) in others {
                assert_eq!(reply.header(name), Some(value), "{path}");
            }
            assert!(!reply.head.to_ascii_lowercase().contains("access-control"), "{}", reply.head);
            // The page's files have no secret.
            assert!(!String::from_utf8_lossy(&reply.body).contains(page.token));
        }
    });
}

#[test]
fn no_request_names_a_file() {
    served(|page| {
        let paths = [
            "/etc/passwd",
            "/../../../../etc/passwd",
            "/web/../app.css",
            "/app.css/",
            "//app.css",
            "/%61pp.css",
            "/app.css?x",
            "/index.html",
            "/main.js\\..",
            "file:///etc/passwd",
            "http://127.0.0.1/app.css",
            "*",
            "/info",
            "/frame",
        ];
        for path in paths {
            assert!([400, 404].contains(&page.get(path).status), "{path}");
        }
        assert_eq!(page.post("/app.css", &json!({})).status, 404);
        assert_eq!(page.post("/etc/passwd", &json!({})).status, 404);
    });
}

#[test]
fn only_the_own_page_under_the_own_name_is_answered() {
    served(|page| {
        let port = page.port;
        for host in [
            "evil.example".to_owned(),
            format!("evil.example:{port}"),
            "127.0.0.1".to_owned(),
            "localhost".to_owned(),
            format!("127.0.0.1:{}", port ^ 1),
            format!("127.0.0.1.evil.example:{port}"),
            format!("127.0.0.1:{port}.evil.example"),
            format!("0.0.0.0:{port}"),
            format!("[::1]:{port}"),
            format!("user@127.0.0.1:{port}"),
            String::new(),
        ] {
            let reply = page.ask("GET / HTTP/1.1", &[&format!("Host: {host}")], "");
            assert_eq!(reply.status, 403, "{host}");
        }
        assert_eq!(page.ask("GET / HTTP/1.1", &["Accept: */*"], "").status, 403, "no host");
        let twice = [&*page.host(), "Host: evil.example"];
        assert_eq!(page.ask("GET / HTTP/1.1", &twice, "").status, 403, "two hosts");
        let local = format!("Host: localhost:{port}");
        assert_eq!(page.ask("GET / HTTP/1.1", &[&local], "").status, 200);

        let origins = [
            "http://evil.example".to_owned(),
            "null".to_owned(),
            format!("http://127.0.0.1:{}", port ^ 1),
            format!("https://127.0.0.1:{port}"),
            format!("http://localhost:{port}"),
        ];
        for origin in origins {
            let reply =
                page.ask("GET / HTTP/1.1", &[&page.host(), &format!("Origin: {origin}")], "");
            assert_eq!(reply.status, 403, "{origin}");
        }
        for (site, status) in [
            ("cross-site", 403),
            ("same-site", 403),
            ("", 403),
            ("same-origin", 200),
            ("none", 200),
        ] {
            let reply =
                page.ask("GET / HTTP/1.1", &[&page.host(), &format!("Sec-Fetch-Site: {site}")], "");
            assert_eq!(reply.status, status, "{site}");
        }
    });
}

#[test]
fn questions_need_the_token() {
    served(|page| {
        assert_eq!(page.token.len(), 48, "192 bits");
        let ask = |path: &str, token: Option<&str>| {
            let host = page.host();
            let token = token.map(|token| format!("X-Firsthit-Token: {token}"));
            let mut lines = vec![&*host, "Content-Length: 2"];
            lines.extend(token.as_deref());
            page.ask(&format!("POST {path} HTTP/1.1"), &lines, "{}").status
        };
        let mut wrong = page.token.to_owned();
        let last = if wrong.ends_with('0') { "1" } else { "0" };
        wrong.replace_range(47.., last);
        for path in ["/info", "/frame", "/probe", "/camera", "/alive"] {
            for token in [None, Some(""), Some("x"), Some(&*wrong), Some(&page.token[..47])] {
                assert_eq!(ask(path, token), 403, "{path} {token:?}");
            }
        }
        assert_eq!(ask("/info", Some(page.token)), 200);
        assert_eq!(ask(&format!("/info?{}", page.token), None), 403);
        let cookie = [
            &*page.host(),
            &format!("Cookie: X-Firsthit-Token={}", page.token),
            "Content-Length: 2",
        ];
        assert_eq!(page.ask("POST /info HTTP/1.1", &cookie, "{}").status, 403);
    });
}

#[test]
fn tokens_differ() {
    let address = || Server::bind(viewer(), 0).unwrap().address();
    let token = |address: String| address.split_once('#').unwrap().1.to_owned();
    assert_ne!(token(address()), token(address()));
}

/// A first line, other lines of a head, a body, and the status that answers them.
type Refused<'a> = (&'a str, &'a [&'a str], &'a str, u16);

impl Page<'_> {
    fn refuses(self, requests: &[Refused<'_>]) {
        let own = [self.host(), format!("X-Firsthit-Token: {}", self.token)];
        for (first, lines, body, status) in requests {
            let own = own.iter().map(String::as_str);
            let lines: Vec<&str> = own.chain(lines.iter().copied()).collect();
            let reply = self.ask(first, &lines, body);
            assert_eq!(reply.status, *status, "{first} {lines:?}");
            assert_eq!(reply.header("connection"), Some("close"), "{first}");
            let head = reply.head.to_ascii_lowercase();
            assert!(!head.contains("access-control"), "{first}");
        }
    }
}

#[test]
fn what_is_no_plain_request_is_refused() {
    let preflight = ["Access-Control-Request-Method: POST", "Origin: http://evil.example"];
    served(|page| {
        page.refuses(&[
            // Nothing is allowed to other pages.
            ("OPTIONS /info HTTP/1.1", &preflight, "", 405),
            ("HEAD / HTTP/1.1", &[], "", 405),
            ("PUT / HTTP/1.1", &[], "", 405),
            ("DELETE / HTTP/1.1", &[], "", 405),
            ("CONNECT evil.example:443 HTTP/1.1", &[], "", 405),
            ("TRACE / HTTP/1.1", &[], "", 405),
            ("get / HTTP/1.1", &[], "", 405),
            ("GET / HTTP/1.0", &[], "", 505),
            ("PRI * HTTP/2.0", &[], "SM\r\n\r\n", 505),
            ("GET  / HTTP/1.1", &[], "", 400),
            ("GET / HTTP/1.1", &["Bad Name: 1"], "", 400),
            ("GET / HTTP/1.1", &["X: a\u{0}b"], "", 400),
            ("\u{1}\u{2}\u{3}", &[], "", 400),
        ]);
    });
}

#[test]
fn a_body_has_one_length_that_is_known() {
    let huge = "Content-Length: 99999999999999999999999";
    let length = "Content-Length: 2";
    let chunked = "Transfer-Encoding: chunked";
    served(|page| {
        page.refuses(&[
            ("POST /info HTTP/1.1", &[], "", 411),
            ("POST /info HTTP/1.1", &[chunked], "0\r\n\r\n", 501),
            ("POST /info HTTP/1.1", &[chunked, length], "{}", 501),
            ("POST /info HTTP/1.1", &["Expect: 100-continue", length], "{}", 501),
            ("POST /info HTTP/1.1", &[length, length], "{}", 400),
            ("POST /info HTTP/1.1", &["Content-Length: +2"], "{}", 400),
            ("POST /info HTTP/1.1", &["Content-Length: 2, 2"], "{}", 400),
            ("POST /info HTTP/1.1", &["Content-Length: 65537"], "", 413),
            ("POST /info HTTP/1.1", &[huge], "", 413),
            ("GET / HTTP/1.1", &[length], "{}", 400),
        ]);
    });
}

#[test]
fn heads_have_a_size() {
    served(|page| {
        let host = page.host();
        let with = |extra: usize| {
            let many: Vec<String> = (0..extra).map(|k| format!("X-{k}: 1")).collect();
            let lines: Vec<&str> =
                std::iter::once(&*host).chain(many.iter().map(String::as_str)).collect();
            page.ask("GET / HTTP/1.1", &lines, "").status
        };
        assert_eq!(with(47), 200);
        assert_eq!(with(48), 431);
        let long = |length: usize| {
            let line = format!("X: {}", "a".repeat(length));
            page.ask("GET / HTTP/1.1", &[&host, &line], "").status
        };
        assert_eq!(long(15_000), 200);
        assert_eq!(long(17_000), 431);
        assert_eq!(long(1_000_000), 431);
    });
}

#[test]
fn a_connection_takes_one_request_after_the_other() {
    served(|page| {
        let mut stream = TcpStream::connect(("127.0.0.1", page.port)).unwrap();
        let one = format!("GET /app.css HTTP/1.1\r\n{}\r\n\r\n", page.host());
        // Two at once, and a third byte by byte.
        stream.write_all(format!("{one}{one}").as_bytes()).unwrap();
        let first = read_reply(&mut stream);
        assert_eq!(first.header("connection"), Some("keep-alive"));
        assert_eq!(first.body, read_reply(&mut stream).body);
        for byte in one.bytes() {
            stream.write_all(&[byte]).unwrap();
        }
        assert_eq!(read_reply(&mut stream).status, 200);
        let last = format!("GET / HTTP/1.1\r\n{}\r\nConnection: close\r\n\r\n", page.host());
        stream.write_all(last.as_bytes()).unwrap();
        assert_eq!(read_reply(&mut stream).header("connection"), Some("close"));
        assert_eq!(stream.read(&mut [0]).unwrap(), 0, "it is closed");
    });
}

#[test]
fn more_connections_than_sixteen_are_turned_away() {
    served(|page| {
        let connect = || TcpStream::connect(("127.0.0.1", page.port)).unwrap();
        let mut open: Vec<TcpStream> = (0..16).map(|_| connect()).collect();
        for stream in &mut open {
            let token = format!("X-Firsthit-Token: {}", page.token);
            let one = format!(
                "POST /alive HTTP/1.1\r\n{}\r\n{token}\r\nContent-Length: 0\r\n\r\n",
                page.host()
            );
            stream.write_all(one.as_bytes()).unwrap();
            assert_eq!(read_reply(stream).status, 200);
        }
        assert_eq!(page.get("/").status, 503);
        drop(open);
        let started = Instant::now();
        while page.get("/").status == 503 {
            assert!(started.elapsed() < Duration::from_secs(20), "places become free again");
            sleep(Duration::from_millis(10));
        }
    });
}

/// Whoever says nothing, or has no token, keeps nobody out.
#[test]
fn strangers_make_room() {
    served(|page| {
        let connect = || TcpStream::connect(("127.0.0.1", page.port)).unwrap();
        let mut silent: Vec<TcpStream> = (0..16).map(|_| connect()).collect();
        let started = Instant::now();
        assert_eq!(page.post("/alive", &json!({})).status, 200);
        assert!(started.elapsed() < Duration::from_secs(4));
        // The oldest has gone, and no other.
        assert_eq!(silent[0].read(&mut [0]).unwrap(), 0);
        let last = silent.last_mut().unwrap();
        let one = format!("GET /app.css HTTP/1.1\r\n{}\r\n\r\n", page.host());
        last.write_all(one.as_bytes()).unwrap();
        assert_eq!(read_reply(last).status, 200);
    });
}

#[test]
fn it_listens_on_one_address_alone() {
    served(|page| {
        assert!(TcpStream::connect(("127.0.0.1", page.port)).is_ok());
        // Of this machine too, but another.
        if cfg!(target_os = "linux") {
            assert!(TcpStream::connect(("127.0.0.2", page.port)).is_err());
        }
        assert!(TcpStream::connect(("::1", page.port)).is_err());
    });
}

#[test]
fn it_ends_after_the_last_page() {
    let lingers = Some(Duration::from_millis(50));
    let server = Server::bind(viewer(), 0).unwrap().lingering(lingers);
    let address = server.address();
    let (place, token) = address.split_once("/#").unwrap();
    let port = place.rsplit(':').next().unwrap().parse().unwrap();
    let page = Page { port, token };
    std::thread::scope(|scope| {
        let running = scope.spawn(|| server.run(&|| false));
        // Before a page has asked it waits.
        sleep(Duration::from_millis(200));
        assert!(!running.is_finished());
        assert_eq!(page.post("/alive", &json!({})).status, 200);
        running.join().unwrap();
    });
}

#[test]
fn questions_that_make_no_sense_are_answered_in_words() {
    served(|page| {
        let camera = page.camera();
        let with = |name: &str, value: Value| {
            let mut other = camera.clone();
            other[name] = value;
            page.post("/frame", &json!({"camera": other}))
        };
        let wrong = [
            ("rows", json!(0), "rows"),
            ("rows", json!(8193), "8192"),
            ("columns", json!(1_000_000), "columns"),
            ("columns", json!(-1), "-1"),
            ("focal_length", json!(0.0), "focal_length"),
            ("aim", json!([0.0, 0.0, 0.0]), "aim"),
            ("up", json!([0.0, 1.0]), "length"),
            ("position", json!([0.0, 0.0, null]), "null"),
            ("height", json!("1"), "string"),
            ("turned", json!(1), "turned"),
        ];
        for (name, value, words) in wrong {
            let reply = with(name, value.clone());
            assert_eq!(reply.status, 400, "{name} {value}");
            let error = reply.json()["error"].as_str().unwrap().to_owned();
            assert!(error.contains(words), "{name} {value}: {error}");
        }
        let looks = [
            json!({"camera": camera, "channel": "depht"}),
            json!({"camera": camera, "channel": "uv", "samples": 0}),
            json!({"camera": camera, "is_lit": true, "samples": 0}),
            json!({"camera": camera, "is_lit": true, "light": "moon"}),
            json!({"camera": camera, "is_lit": true, "sun": [0.0, 0.0, 0.0]}),
            json!({"camera": camera, "part": {"hidden": [2]}}),
            json!({"camera": camera, "part": {"only": [2]}}),
            json!({"camera": camera, "part": {"only": [0], "hidden": [1]}}),
            json!({"camera": camera, "light": "moon"}),
            json!({"camera": camera, "edges": 1.0, "part": {"cut": {"normal": [0.0, 0.0, 1.0], "offset": 1.0}}}),
            json!({"camera": camera, "part": {"cut": {"normal": [0.0, 0.0, 0.0], "offset": 1.0}}}),
            json!({"camera": camera, "is_lit": true, "edges": -1.0}),
            json!({"camera": camera, "file": "/etc/passwd"}),
            json!([]),
        ];
        for look in looks {
            let reply = page.post("/frame", &look);
            assert_eq!(reply.status, 400, "{look}");
            assert!(reply.json()["error"].is_string());
        }
        for body in ["", "{", "{\"camera\": NaN}", "\u{7f}"] {
            let host = page.host();
            let token = format!("X-Firsthit-Token: {}", page.token);
            let length = format!("Content-Length: {}", body.len());
            assert_eq!(
                page.ask("POST /frame HTTP/1.1", &[&host, &token, &length], body).status,
                400,
                "{body}"
            );
        }
        let outside = json!({"camera": camera, "pixel": [0, 64]});
        assert_eq!(page.post("/probe", &outside).status, 400);
    });
}

#[test]
fn a_page_is_told_what_there_is() {
    served(|page| {
        let info = page.post("/info", &json!({})).json();
        assert_eq!(info["title"], "two balls");
        assert_eq!(info["objects"][0]["name"], "<img src=x onerror=alert(1)>");
        assert_eq!(info["objects"][1]["shape"], "sphere");
        assert_eq!(info["bounds"], json!([[-1.0, -1.0, -1.0], [4.0, 1.0, 1.0]]));
        assert_eq!(info["maps"]["viridis"].as_array().unwrap().len(), 256);
        let names = info["channels"]
            .as_array()
            .unwrap()
            .iter()
            .map(|channel| channel["name"].as_str().unwrap());
        for name in names {
            let look = json!({"camera": page.camera(), "channel": name});
            assert_eq!(page.post("/frame", &look).status, 200, "{name}");
        }
    });
}

/// The distance to the ball next to the picture's middle is known.
#[test]
fn hidden_objects_and_cuts_are_looked_through() {
    served(|page| {
        let mut camera = page.camera();
        camera["position"] = json!([0.0, -9.0, 0.0]);
        let middle = |part: Value| {
            let asked = json!({"camera": camera, "pixel": [24, 32], "part": part});
            page.post("/probe", &asked).json()["hit"].clone()
        };
        let near = |found: &Value, expected: f64| {
            let t = found["t"].as_f64().unwrap();
            assert!((t - expected).abs() < 0.02, "{t} {expected}");
        };
        near(&middle(json!({})), 8.0);
        assert_eq!(middle(json!({"hidden": [0]})), Value::Null);
        assert_eq!(middle(json!({"only": [1]})), Value::Null);
        near(&middle(json!({"only": [0]})), 8.0);
        near(&middle(json!({"hidden": [1, 1]})), 8.0);
        near(&middle(json!({"cut": {"normal": [0.0, -1.0, 0.0], "offset": 0.0}})), 10.0);
        assert_eq!(
            middle(json!({"cut": {"normal": [0.0, 1.0, 0.0], "offset": -2.0}})),
            Value::Null
        );
        let far = json!({"camera": camera, "channel": "t", "part": {"cut": {"normal": [0.0, -1.0, 0.0], "offset": 0.0}}});
        let reply = page.post("/frame", &far);
        let about: Value = serde_json::from_str(reply.header("x-firsthit-frame").unwrap()).unwrap();
        assert_eq!((&about["dtype"], &about["rows"]), (&json!("float32"), &json!(48)));
        let mut bytes = Vec::new();
        flate2::read::ZlibDecoder::new(&*reply.body).read_to_end(&mut bytes).unwrap();
        let numbers: Vec<f32> =
            bytes.chunks(4).map(|four| f32::from_le_bytes(four.try_into().unwrap())).collect();
        assert_eq!(numbers.len(), 48 * 64);
        assert!((numbers[24 * 64 + 32] - 10.0).abs() < 0.02);
    });
}

/// Samples that are added to a picture give the bytes of all at once, also after another picture.
#[test]
fn a_picture_goes_on_where_it_was() {
    served(|page| {
        let look =
            |samples: u32| json!({"camera": page.camera(), "is_lit": true, "samples": samples});
        let picture = |samples| {
            let reply = page.post("/frame", &look(samples));
            assert_eq!((reply.status, reply.header("content-type")), (200, Some("image/png")));
            reply.body
        };
        let at_once = picture(5);
        let fewer = picture(2);
        assert_ne!(at_once, fewer);
        assert_eq!(picture(5), at_once);
        let other =
            json!({"camera": page.camera(), "is_lit": true, "samples": 3, "light": "headlight"});
        assert_eq!(page.post("/frame", &other).status, 200);
        assert_eq!(picture(5), at_once);
        assert_eq!(picture(5), at_once);
    });
}

/// Whoever goes away takes the work along: places become free.
#[test]
fn a_frame_ends_when_nobody_waits_for_it() {
    served(|page| {
        let mut camera = page.camera();
        (camera["rows"], camera["columns"]) = (json!(1000), json!(1000));
        let body = json!({"camera": camera, "is_lit": true, "samples": 1_000_000}).to_string();
        let head = format!(
            "POST /frame HTTP/1.1\r\n{}\r\nX-Firsthit-Token: {}\r\nX-Firsthit-Page: ",
            page.host(),
            page.token
        );
        let ask = |number: usize| {
            let mut stream = TcpStream::connect(("127.0.0.1", page.port)).unwrap();
            let rest = format!("{number}\r\nContent-Length: {}\r\n\r\n{body}", body.len());
            stream.write_all(format!("{head}{rest}").as_bytes()).unwrap();
            stream
        };
        let many: Vec<TcpStream> = (0..16).map(ask).collect();
        // They are known by their tokens before anyone else comes.
        sleep(Duration::from_secs(1));
        let started = Instant::now();
        while page.get("/").status != 503 {
            assert!(started.elapsed() < Duration::from_secs(20), "all places are taken");
        }
        drop(many);
        while page.get("/").status != 200 {
            assert!(started.elapsed() < Duration::from_secs(60), "places become free");
            sleep(Duration::from_millis(20));
        }
    });
}

#[test]
fn a_newer_frame_of_a_page_ends_the_older() {
    served(|page| {
        let mut camera = page.camera();
        (camera["rows"], camera["columns"]) = (json!(2000), json!(3000));
        let long = json!({"camera": camera, "is_lit": true, "samples": 4096});
        std::thread::scope(|scope| {
            let older = scope.spawn(|| page.post("/frame", &long).status);
            sleep(Duration::from_millis(300));
            let newer = page.post("/frame", &json!({"camera": page.camera()}));
            assert_eq!(newer.status, 200);
            assert_eq!(older.join().unwrap(), 409);
        });
    });
}
