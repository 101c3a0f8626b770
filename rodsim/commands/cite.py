"""``rodsim cite``: the entries of CITATION.cff, as text and for BibTeX."""

import click


@click.command()
@click.option("--bibtex", is_flag=True, help="Only the entries for BibTeX.")
def cite(bibtex):
    """Print how to cite rodsim and the paper of its method, as text and for BibTeX."""
    works = _works()
    if not bibtex:
        click.echo("\n\n".join(_sentence(work) for work in works) + "\n")
    click.echo("\n\n".join(_entry(work) for work in works))


def _works() -> list[dict]:
    """Return rodsim of this version, then what it refers to."""
    import yaml

    import rodsim
    from rodsim.files import shipped

    own = yaml.safe_load(shipped("CITATION.cff").read_text(encoding="utf-8"))
    own |= {"version": rodsim.__version__, "url": _home()}
    return [own, *own["references"]]


def _home() -> str | None:
    """Return the address of the source, where whoever packaged rodsim has given one."""
    from importlib.metadata import PackageNotFoundError, metadata

    try:
        urls = metadata("rodsim").get_all("Project-URL") or []
    except PackageNotFoundError:  # run from a folder that is not installed
        return None
    named = dict(url.split(", ", 1) for url in urls)
    return named.get("Source")


def _names(work, joint: str) -> str:
    return joint.join(
        author.get("name") or f"{author['family-names']}, {author['given-names']}"
        for author in work["authors"]
    )


def _sentence(work) -> str:
    if work["type"] == "article":
        where = f"{work['journal']} {work['volume']} ({work['year']}) {_pages(work)}"
        return f"{_names(work, '; ')}: {work['title']}. {where}. https://doi.org/{work['doi']}"
    where = f" {work['url']}" if work["url"] else ""
    return f"{_names(work, '; ')}: {work['title']}, version {work['version']}.{where}"


def _entry(work) -> str:
    """Return a work as an entry of BibTeX."""
    by, kind = _names(work, " and "), "misc"
    if work["type"] == "article":
        key, kind = f"{work['authors'][0]['family-names']}{work['year']}", "article"
        fields = {name: work[name] for name in ("journal", "volume")}
        fields |= {"pages": _pages(work).replace("\u2013", "--")}
        fields |= {"year": work["year"], "doi": work["doi"]}
    else:
        key, by = f"rodsim-{work['version']}", f"{{{by}}}"  # one name, not two
        fields = {"note": f"Version {work['version']}", "url": work["url"]}
    fields = {"author": by, "title": f"{{{work['title']}}}"} | fields
    lines = [f"  {name} = {{{value}}}," for name, value in fields.items() if value]
    return "\n".join([f"@{kind}{{{key},", *lines, "}"])


def _pages(work) -> str:
    return f"{work['start']}\u2013{work['end']}"
