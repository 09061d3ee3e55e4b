"""The plugin of pytest that the installed package brings, for a folder that was never installed."""

pytest_plugins = ["verification.conformance.plugin"]
