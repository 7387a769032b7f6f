"""The README's option table is what the command prints."""

from _command import SOURCE, check, finish, run, skip

START, END = "<!-- options: vdb-offset mesh --help-markdown -->", "<!-- end of options -->"

readme = SOURCE / "README.md"
if not readme.is_file():
    skip("there is no README.md")
text = readme.read_text()
check("README.md marks its option table", START in text and END in text, f"{START} ... {END}")
if START in text and END in text:
    table = text.split(START)[1].split(END)[0].strip()
    printed = run("mesh", "--help-markdown").stdout.strip()
    check("the table in README.md equals 'mesh --help-markdown'", table == printed, printed)
    wrong = [line for line in printed.splitlines() if line.count("|") != 7]
    check("every row has six cells", printed and not wrong, wrong)

finish()
