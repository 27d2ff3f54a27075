//! stub
use crate::report::{Error, OutFile};
use std::path::{Path, PathBuf};
pub struct Results(PathBuf);

impl Results {
    pub fn of(d: &Path, out: Option<&Path>) -> Result<Self, Error> {
        let s = d.with_extension("enfilade");
        Ok(Self(match out {
            Some(o) => o.join(s.file_name().unwrap()),
            None => s,
        }))
    }
    pub fn lock(&self) -> Result<(), Error> {
        Ok(())
    }
    pub fn next_round(&self) -> Result<u32, Error> {
        Ok(1)
    }
    fn put(&self, n: &str, f: &[OutFile]) -> Result<PathBuf, Error> {
        let d = self.0.join(n);
        std::fs::create_dir_all(&d).unwrap();
        for x in f {
            std::fs::write(d.join(&x.path), &x.bytes).unwrap();
        }
        Ok(d)
    }
    pub fn publish_analysis(&self, f: &[OutFile]) -> Result<PathBuf, Error> {
        self.put("analysis", f)
    }
    pub fn publish_round(&self, f: &[OutFile]) -> Result<PathBuf, Error> {
        self.put("round-01", f)
    }
    pub fn read_round(&self, _r: Option<u32>) -> Result<(u32, Vec<u8>), Error> {
        Ok((1, std::fs::read(self.0.join("round-01/result.json")).unwrap()))
    }
}
pub fn write_file(p: &Path, b: &[u8]) -> Result<(), Error> {
    std::fs::write(p, b).unwrap();
    Ok(())
}
pub fn write_new(p: &Path, b: &[u8]) -> Result<(), Error> {
    write_file(p, b)
}
pub fn write_accepted(d: &Path, a: &[u8], s: &[u8]) -> Result<(PathBuf, PathBuf), Error> {
    let x = d.with_file_name("acc-r02.dxf");
    let y = d.with_file_name("acc-r02.enfilade.toml");
    write_file(&x, a)?;
    write_file(&y, s)?;
    Ok((x, y))
}
