"""Energies over time."""

from itertools import cycle

from rodsim.plotting import style


def plot_energies(table, path) -> None:
    """Draw the energies of an :class:`~rodsim.analysis.energy.EnergyTable` over time to a file."""
    figure = style.new_figure(6.4, 4.2)
    draw_energies(figure.add_subplot(), table)
    style.save(figure, path)


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
    axis.set_ylabel(style.label("energy", table.unit))
    handles, labels = axis.get_legend_handles_labels()
    if "kinetic" in table.columns:
        right = axis.twinx()
        kinetic = table.rows[:, table.columns.index("kinetic")]
        handles += right.plot(time, kinetic, color="0.4", ls=(0, (5, 1, 1, 1)), lw=1.4)
        labels.append("kinetic (right)")
        right.set_ylabel(style.label("kinetic energy", table.unit))
    axis.legend(handles, labels, frameon=False)
    axis.set_xlim(time[0], time[-1])
    return axis
