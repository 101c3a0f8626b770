"""Energies over time."""

from itertools import cycle

from rodsim.plotting import style


@style.styled
def plot_energies(table, path, sheet=style.PLAIN) -> None:
    """Draw the energies of an :class:`~rodsim.analysis.energy.EnergyTable` over time to a file."""
    figure = sheet.figure(6.4, 4.2)
    draw_energies(figure.add_subplot(), table)
    sheet.save(figure, path)


def draw_energies(axis, table):
    """Draw the energies on a matplotlib axis (kinetic energy on its own scale); return the axis."""
    drawn = [name for name in table.columns[1:] if name not in ("kinetic", "work", "dissipated")]
    styles = dict(zip(drawn, cycle(("-", "--", ":", "-.")), strict=False), total="-")
    time = table.rows[:, 0]
    for column in drawn:
        values = table.rows[:, table.columns.index(column)]
        width = 2.4 if column == "total" else 1.4
        axis.plot(time, values, styles[column], lw=width, label=column)
    style.scale(axis, table.rows[:, table.columns.index("total")])
    axis.set_xlabel(style.label("time", table.time_unit))
    style.name_values(axis, "energy", table.unit)
    handles, labels = axis.get_legend_handles_labels()
    if "kinetic" in table.columns:
        right = axis.twinx()
        kinetic = table.rows[:, table.columns.index("kinetic")]
        handles += right.plot(time, kinetic, color="0.4", ls=(0, (5, 1, 1, 1)), lw=1.4)
        labels.append("kinetic (right)")
        style.name_values(right, "kinetic energy", table.unit)
    style.legend_above(axis, handles, labels)
    axis.set_xlim(time[0], time[-1])
    return axis
