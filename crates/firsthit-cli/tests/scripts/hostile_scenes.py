"""Hostile scene files: deep, long, self-naming, and with numbers and files where there are none."""

BALL = '[[objects]]\nshape = "sphere"\ncenter = [0, 0, 0]\nradius = 1\n'
VALUES = [
    "nan", "inf", "-inf", "1e308", "-1e308", "1e999", "9223372036854775808", "-9223372036854775808",
    "0", "-0.0", "1e-320", '"x"', "true", "[]", "{}", "[[0,0,0]]", "[0,0]", "[nan,0,0]", "[1e300,0,0]",
    "[" * 200 + "]" * 200, "[" * 100_000, "1979-05-27", '"\\u0000"', '"""\n"""', "0x7fffffffffffffff",
]  # fmt: skip


def nested() -> list[str]:
    """Tables in tables, in each of the ways that TOML has."""
    return [
        "a = " + "{a = " * 100_000,
        "a = " + "{a = " * 60 + "1" + "}" * 60,
        ".".join("a" * 1 for _ in range(100_000)) + " = 1",
        "[" + ".".join("a" for _ in range(100_000)) + "]",
        "\n".join(f"[{'.'.join(['a'] * k)}]" for k in range(1, 1200)),
        "a = " + "[" * 1_000_000,
        "[[" * 100_000,
    ]


def long() -> list[str]:
    """Much of everything."""
    return [
        "\n".join(f"k{k} = 1" for k in range(1_000_000)),
        "x = 1\n" * 100_000,
        "a" * 1_000_000 + " = 1",
        '"' + "\\n" * 100_000 + '" = 1',
        'x = "' + "y" * 1_000_000,
        "".join(BALL.replace("[0,", f"[{k},") for k in range(100_000)),
        BALL + "[[lights]]\n" * 100_000,
        "".join(f'[[outputs]]\nfile = "{k}.png"\n' for k in range(1000)) + BALL,
        "#" * 1_000_000,
        "\n" * 1_000_000,
        "[cameras]\n" + "".join(f"[cameras.c{k}]\nposition = [{k}, 0, 0]\n" for k in range(50_000)),
    ]


def numbers() -> list[str]:
    """Every kind of value, wherever one may stand."""
    files = [BALL.replace("radius = 1", f"radius = {value}") for value in VALUES]
    files += [BALL.replace("[0, 0, 0]", value) for value in VALUES]
    for key in ("position", "look_at", "aim", "up", "fov", "columns", "rows", "near"):
        files += [f"{BALL}[camera]\n{key} = {value}\n" for value in VALUES]
    for key in ("scale", "rotate", "translate", "matrix", "name", "color", "shape", "file"):
        files += [f"{BALL}{key} = {value}\n" for value in VALUES]
    files += [f"{BALL}[shading]\nsamples = {value}\n" for value in VALUES]
    for columns, rows in ((1 << 31, 1 << 31), (1 << 62, 4), (100_000, 100_000), (1, 1 << 32)):
        files.append(f"{BALL}[camera]\nposition = [0, 0, 9]\nlook_at = [0, 0, 0]\ncolumns = {columns}\nrows = {rows}\n")
    return files


def elsewhere(outside: list[str]) -> list[str]:
    """Objects and outputs outside the folder, and the file itself."""
    quoted = [name.encode("unicode_escape").decode().replace('"', '\\"') for name in [*outside, "a.toml", "./a.toml"]]
    quoted = [name.replace("\\x", "\\u00") for name in quoted]
    files = [f'{BALL}[[objects]]\nfile = "{name}"\n' for name in quoted]
    files += [f'{BALL}[[outputs]]\nfile = "{name}"\n' for name in quoted if name]
    return files + [
        f'{BALL}[[outputs]]\nfile = "{name}.png"\n' for name in ("../out", "/tmp/out", "sub/../../out", "link/x")
    ]


def crowds() -> list[str]:
    """Files named again and again."""
    one = '[[objects]]\nfile = "tri.obj"\n'
    # Rays that leave one of many in one place ask the first of them only.
    return [
        one * 3000,
        "".join(f"{one}translate = [{k}, 0, 0]\n" for k in range(100_000)),
        "".join(f'[[objects]]\nfile = "{"./" * k}tri.obj"\n' for k in range(0, 500, 2)),
    ]


def files(outside: list[str]) -> list[tuple[str, bytes]]:
    """All of them, with their extension."""
    texts = nested() + long() + numbers() + elsewhere(outside) + crowds()
    contents = [text.encode(errors="surrogatepass") for text in texts]
    contents += [b"", b"\x00", b"\xff\xfe\x00", b"\xef\xbb\xbf" + BALL.encode(), BALL.encode("utf-16"), b"\x80 = 1"]
    return [(".toml", content) for content in contents]
