"""Pictures by rasterization: three.js in a headless browser, a second or so for each."""
