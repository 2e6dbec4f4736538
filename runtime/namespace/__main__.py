"""``python -m ltcgear``: the command line."""

from ltcgear.runtime.cli.entry import main

main()
