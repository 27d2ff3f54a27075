//! What everybody may read of the page.

/// What everybody on this machine may read: it holds nothing of the daemon's. Address, media type and text.
pub(super) const ASSETS: [(&str, &str, &str); 7] = [
    ("/", HTML, include_str!("page/index.html")),
    ("/page.css", "text/css; charset=utf-8", include_str!("page/page.css")),
    ("/page.js", SCRIPT, include_str!("page/page.js")),
    ("/login.js", SCRIPT, include_str!("page/login.js")),
    ("/news.js", SCRIPT, include_str!("page/news.js")),
    ("/options.js", SCRIPT, include_str!("page/options.js")),
    ("/plots.js", SCRIPT, include_str!("page/plots.js")),
];
const HTML: &str = "text/html; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";
