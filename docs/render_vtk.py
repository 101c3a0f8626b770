"""Draw the last frame of ``rodsim export OUT.h5 -o FILE.vtkhdf`` without a screen.

python docs/render_vtk.py FILE.vtkhdf PICTURE.png: tubes of the radius in the file, coloured by
curvature. The filters are those of ParaView: VTKHDF reader, Tube.
"""

import sys

import vtkmodules.vtkRenderingFreeType
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  (registers what draws)
from vtkmodules.vtkFiltersCore import vtkTubeFilter
from vtkmodules.vtkIOHDF import vtkHDFReader
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkRenderingAnnotation import vtkScalarBarActor
from vtkmodules.vtkRenderingCore import (
    vtkActor,
    vtkColorTransferFunction,
    vtkPolyDataMapper,
    vtkRenderer,
    vtkRenderWindow,
    vtkWindowToImageFilter,
)

VIRIDIS = {0.0: (0.27, 0.0, 0.33), 0.5: (0.13, 0.57, 0.55), 1.0: (0.99, 0.91, 0.14)}


def tubes(path):
    """Read the last step and make tubes of its lines."""
    reader = vtkHDFReader()
    reader.SetFileName(path)
    reader.UpdateInformation()
    reader.SetStep(reader.GetNumberOfSteps() - 1)
    tube = vtkTubeFilter()
    tube.SetInputConnection(reader.GetOutputPort())
    tube.SetInputArrayToProcess(0, 0, 0, 0, "radius")
    tube.SetVaryRadiusToVaryRadiusByAbsoluteScalar()
    tube.SetNumberOfSides(24)
    tube.Update()
    return tube


def coloured(tube, name):
    """Return the tubes and their key, coloured by one of the point arrays."""
    low, high = tube.GetOutput().GetPointData().GetArray(name).GetRange()
    colours = vtkColorTransferFunction()
    for share, rgb in VIRIDIS.items():
        colours.AddRGBPoint(low + share * (high - low), *rgb)
    mapper = vtkPolyDataMapper()
    mapper.SetInputConnection(tube.GetOutputPort())
    mapper.SetLookupTable(colours)
    mapper.SetScalarModeToUsePointFieldData()
    mapper.SelectColorArray(name)
    actor, key = vtkActor(), vtkScalarBarActor()
    actor.SetMapper(mapper)
    key.SetLookupTable(colours)
    key.SetTitle("1/um")
    key.SetNumberOfLabels(4)
    key.SetPosition(0.83, 0.2)
    key.SetMaximumWidthInPixels(90)
    key.SetMaximumHeightInPixels(260)
    key.UnconstrainedFontSizeOn()
    for text in (key.GetTitleTextProperty(), key.GetLabelTextProperty()):
        text.SetColor(0.1, 0.1, 0.1)
        text.SetFontSize(13)
        text.ItalicOff()
        text.ShadowOff()
    return actor, key


def render(actor, key, path):
    """Draw into memory and write a PNG."""
    renderer, window = vtkRenderer(), vtkRenderWindow()
    renderer.SetBackground(1.0, 1.0, 1.0)
    renderer.AddActor(actor)
    renderer.AddViewProp(key)
    renderer.GetActiveCamera().SetPosition(-2, 6, 10)
    renderer.ResetCamera()
    renderer.GetActiveCamera().Zoom(1.2)
    window.SetOffScreenRendering(True)
    window.SetMultiSamples(8)
    window.SetSize(720, 480)
    window.AddRenderer(renderer)
    window.Render()
    grab, writer = vtkWindowToImageFilter(), vtkPNGWriter()
    grab.SetInput(window)
    writer.SetFileName(path)
    writer.SetInputConnection(grab.GetOutputPort())
    writer.Write()


if __name__ == "__main__":
    render(*coloured(tubes(sys.argv[1]), "curvature"), sys.argv[2])
