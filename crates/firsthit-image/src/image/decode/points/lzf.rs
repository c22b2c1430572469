//! Marc Lehmann's LZF, by which PCL packs points.

/// The content of `packed`, which must be `length` bytes.
pub(super) fn unpacked(packed: &[u8], length: usize) -> Result<Vec<u8>, &'static str> {
    /// The most bytes that three packed bytes stand for.
    const MOST: usize = 264;
    const DAMAGED: &str = "has compressed points that are damaged";
    if length > packed.len().saturating_mul(MOST) {
        return Err(DAMAGED);
    }
    let mut out: Vec<u8> = Vec::new();
    out.try_reserve_exact(length).map_err(|_| "no memory is free for its points")?;
    let mut bytes = packed.iter().copied();
    while let Some(control) = bytes.next() {
        let control = usize::from(control);
        let mut next = || bytes.next().map(usize::from).ok_or(DAMAGED);
        if control < 32 {
            for _ in 0..=control {
                out.push(bytes.next().ok_or(DAMAGED)?);
            }
        } else {
            let mut count = (control >> 5) + 2;
            if count == 9 {
                count += next()?;
            }
            let back = ((control & 31) << 8) + next()? + 1;
            let start = out.len().checked_sub(back).ok_or(DAMAGED)?;
            for place in start..start + count {
                out.push(*out.get(place).ok_or(DAMAGED)?);
            }
        }
        if out.len() > length {
            return Err(DAMAGED);
        }
    }
    if out.len() == length { Ok(out) } else { Err(DAMAGED) }
}
