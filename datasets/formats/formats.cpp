#include "datasets/formats/formats.h"

#include <algorithm>

namespace hausbench {
namespace readers {

// The readers of the table. Each is defined in a file of this folder.
Read read_obj, read_off, read_ply, read_stl, read_gltf, read_3mf, read_amf, read_collada, read_vrml, read_vtk,
    read_vtk_xml, read_medit, read_gmsh, read_dxf, read_fbx, read_3ds, read_pcd, read_xyz, read_csv;

}  // namespace readers

namespace {

using namespace readers;

const std::vector<Format> table = {
    {{"obj"},
     "Wavefront OBJ",
     read_obj,
     "v, f, fo, l (segments) and p (points); a weight in v is left out with a note",
     "free-form curves and surfaces (cstype, curv, surf, ...), call and csh",
     "not stated",
     "not stated",
     "none: the double nearest to each decimal number"},
    {{"off"},
     "OFF",
     read_off,
     "OFF, COFF, NOFF, STOFF and 4OFF as text, also with counts that touch the keyword (ModelNet40)",
     "nOFF, 4nOFF and binary OFF",
     "not stated",
     "not stated",
     "none: the double nearest to each decimal number; in 4OFF a quotient of two, rounded once"},
    {{"ply"},
     "PLY",
     read_ply,
     "vertices, faces, triangle strips and edges (segments), as text or binary",
     "files whose only faces are other elements with lists of vertices; in text, coordinates that their integer type "
     "cannot hold",
     "not stated",
     "not stated",
     "none: the stored numbers; in text the nearest float32 or float64, by the property's type"},
    {{"stl"},
     "STL",
     read_stl,
     "facets of all solids, text or binary",
     "nothing",
     "not stated",
     "not stated",
     "none: the stored float32; in text the nearest double"},
    {{"glb", "gltf"},
     "glTF 2.0",
     read_gltf,
     "triangles, strips, fans, lines and points of the default scene, placed by its nodes; buffers inside, "
     "in data: URIs and beside the file; sparse accessors, default morph weights, KHR_mesh_quantization, "
     "EXT_mesh_gpu_instancing, KHR_node_visibility, and (in the program only) EXT_meshopt_compression, "
     "KHR_meshopt_compression and KHR_draco_mesh_compression",
     "skins, version 1 of the vertex codec of KHR_meshopt_compression, every other required extension, several scenes "
     "without a default one, files without a scene, "
     "glTF 1.0, indices that restart a primitive, Draco with strips",
     "metre, by the specification",
     "y up, by the specification",
     "none for float32 and integer accessors without a transform; 1 u for normalized integers; 3 u of the "
     "largest sum for each morph target; (20 k + 4) u of |M1| ... |Mk| |p| under k nodes with a transform "
     "(rotations count as 1); Draco's positions are the float32 numbers of its library"},
    {{"3mf"},
     "3MF",
     read_3mf,
     "triangles of all objects that the build section places, through components and parts in other files "
     "of the archive (production extension)",
     "other required extensions; beam lattices, boolean operations, volumetric data, displacement, "
     "mirrored meshes, alternatives and low-resolution meshes in objects that are used; objects of type "
     "\"other\" in the build; encrypted parts; an empty build. Left out with a note: objects outside of "
     "the build, supports, slices beside a full mesh",
     "the attribute of the model; millimetre if missing",
     "Z up, by the specification",
     "none without a transform; each transform within 4 u of the sum of its terms' magnitudes"},
    {{"amf"},
     "AMF",
     read_amf,
     "triangles of all volumes, placed by constellations if there are any; as XML or as a ZIP archive with "
     "one .amf file",
     "curved triangles (normals or edges); materials that are functions of the place; rotations about more "
     "than one axis; scale factors and mirrors of instances; objects outside of the constellations. Left "
     "out with a note: support volumes",
     "the attribute of the file; millimetre if missing",
     "not stated",
     "none without an instance; each instance within 8 u of |x| + |y| + |z| + |delta|"},
    {{"dae"},
     "Collada",
     read_collada,
     "meshes of the scene's nodes: triangles, fans, strips, polygons, lines, points; node transforms and "
     "instances",
     "skins and morphs, polygons with holes, convex_mesh, spline, brep, files other than this one, "
     "perspective matrices, skew, versions other than 1.4 and 1.5",
     "<unit meter=\"...\"> of the file's <asset>; 1 m if it is missing, by the specification",
     "<up_axis> of the file's <asset>; Y if it is missing, by the specification; stated, not applied",
     "none without transforms; below k transform elements at most 4 k u of the largest sum of |terms|, and "
     "16 u more for each rotate or lookat"},
    {{"wrl", "vrml", "wrz"},
     "VRML 2.0",
     read_vrml,
     "IndexedFaceSet, IndexedLineSet (segments) and PointSet under Transform nodes; with a note, the first level of a "
     "LOD, the choice of a Switch, and a Billboard as it is stored; scripts and animation are left out with a note",
     "VRML 1.0, other shapes (Box, Sphere, Extrusion, ...), PROTO, EXTERNPROTO, Inline, nodes that VRML97 "
     "does not define, fields that a node has twice",
     "metre, by the specification",
     "y up, by the specification",
     "none without Transform nodes; under n of them 200 n u S (|p| + T), see the reader"},
    {{"3ds"},
     "3D Studio",
     read_3ds,
     "triangles of all meshes (hidden ones with a note), in world coordinates as stored; a mesh without faces as "
     "points; the "
     "keyframer (animation) is left out with a note",
     "meshes with left-handed local axes, meshes that the keyframer shows several times",
     "none (the master scale changes nothing)",
     "not stated (Z in 3D Studio)",
     "none: the float32 numbers of the file"},
    {{"dxf"},
     "DXF",
     read_dxf,
     "3DFACE, SOLID, TRACE, MESH, POLYLINE and LWPOLYLINE (lines, polyface and polygon meshes), LINE, "
     "POINT, and INSERT of blocks; those on layers that are off or frozen with a note",
     "binary DXF, other entities with a shape (CIRCLE, ARC, SPLINE, HATCH, 3DSOLID, ...), thickness, "
     "width, bulges, fitted curves, subdivision, references to other files",
     "$INSUNITS of the header",
     "not stated",
     "none outside of blocks; at most 16 u of the sum of |terms| for each INSERT, and for each extrusion "
     "direction other than 0 0 1 and 0 0 -1"},
    {{"vtk"},
     "VTK legacy",
     read_vtk,
     "versions 1.0 to 5.1, text and binary: PolyData (vertices, lines, polygons, triangle strips) and "
     "unstructured grids (points, lines, triangles, strips, polygons, pixels, quadrilaterals)",
     "structured and rectilinear grids, images, curved cells, grids with volume cells and no surface",
     "not stated",
     "not stated",
     "none: the numbers of the file (text of a float array is rounded to float32; integers beyond 2^53 to "
     "double)"},
    {{"vtp", "vtu"},
     "VTK XML",
     read_vtk_xml,
     "PolyData and unstructured grids of any number of pieces, as text, base64 or appended data, "
     "uncompressed or compressed by zlib, in either byte order; the same cells as legacy files",
     "LZ4 and LZMA compression, several time steps, curved cells, grids with volume cells and no surface, "
     "parallel files",
     "not stated",
     "not stated",
     "none: the numbers of the file (text of a Float32 array is rounded to float32; integers beyond 2^53 "
     "to double)"},
    {{"mesh", "meshb"},
     "Medit",
     read_medit,
     "text and binary in either byte order, MeshVersionFormatted 1 to 4, dimension 2 (z = 0, with a note) "
     "and 3: vertices, edges, triangles, quadrilaterals; volume cells beside them are left out with a note",
     "volume cells without surface cells, curved cells (TrianglesP2, QuadrilateralsQ2, ...), polygons, "
     "polyhedra, unknown keywords, MeshVersionFormatted 0",
     "not stated",
     "not stated",
     "none: the numbers of the file; text of MeshVersionFormatted 1 is rounded to float32, as the format "
     "defines"},
    {{"msh"},
     "Gmsh",
     read_gmsh,
     "versions 1.0, 2.0 to 2.2, 4.0 and 4.1, text and binary in either byte order: lines, triangles, "
     "quadrangles, or points alone; volume elements, and points that are not corners (such as the centres of arcs), "
     "beside "
     "them are left out with a note",
     "volume elements without surface elements, curved elements (order 2 and higher), polygons, polyhedra, "
     "version 3",
     "not stated",
     "not stated",
     "none: the numbers of the file"},
    {{"fbx"},
     "FBX",
     read_fbx,
     "versions 7.0 to 7.7, binary and text: polygons and lines of the geometries that the scene's models show, moved "
     "by "
     "the models; hidden models too, and the control meshes of smoothed ones, with a note",
     "skeletons, blend shapes and other deformers, NURBS, patches and other geometries, levels of detail, polygons "
     "marked as holes, FBX 6; transforms on which programs differ (PreRotation without RotationActive, InheritType 0 "
     "and 2 below certain scales, exceeded limits)",
     "UnitScaleFactor (centimetres) of GlobalSettings; 1 cm if it is missing",
     "UpAxis, FrontAxis and CoordAxis of GlobalSettings; Y up if they are missing; stated, not applied; other systems "
     "of axes than those of --up count as not stated, with a note",
     "none without transforms; below k factors of the models' transforms at most 4 k u of the largest sum of |terms|, "
     "and 16 u more for each rotation about an axis"},
    {{"pcd"},
     "Point Cloud Library",
     read_pcd,
     "x, y and z of every point, as ascii, binary or binary_compressed; VIEWPOINT does not move the points, as in "
     "PCL, and is told if it is not the identity",
     "nothing; missing measurements (NaN) only with --drop-invalid",
     "not stated",
     "not stated",
     "none: the stored numbers; in text the nearest float32 or float64, by the field's type"},
    {{"xyz", "pts", "txt", "asc", "xyzn", "xyzrgb"},
     "points as text",
     read_xyz,
     "three columns, columns named by a header or comment, .pts after a count line, six columns of .xyzn "
     "and .xyzrgb, or --columns",
     "more columns without names, latitude and longitude, decimal commas, molecules without --columns",
     "in the names of the columns, as in x [mm]",
     "not stated",
     "none: the double nearest to each decimal number",
     true},
    {{"csv"},
     "points as a table",
     read_csv,
     "three columns, columns named by a header or comment, or --columns",
     "more columns without names, latitude and longitude, decimal commas",
     "in the names of the columns, as in x [mm]",
     "not stated",
     "none: the double nearest to each decimal number",
     true},
};

const std::vector<Unread> unread = {
    {{"step", "stp"},
     "ISO-10303-21",
     "a STEP file",
     "tessellate it in a CAD program, such as FreeCAD or gmsh, and export STL or OBJ"},
    {{"iges", "igs"},
     "",
     "an IGES file",
     "tessellate it in a CAD program, such as FreeCAD or gmsh, and export STL or OBJ"},
    {{"brep", "brp"},
     "",
     "a CAD model",
     "tessellate it in a CAD program, such as FreeCAD or gmsh, and export STL or OBJ"},
    {{"las", "laz"},
     "LASF",
     "a LAS or LAZ point cloud",
     "convert it to .xyz with `las2txt -parse xyz`, or to .ply with `pdal translate`"},
    {{"e57"}, "ASTM-E57", "an E57 point cloud", "convert it to .ply or .xyz with `pdal translate` or CloudCompare"},
    {{"nii"},
     "",
     "an image of voxels",
     "extract the boundary of its label, for example with skimage.measure.marching_cubes, and save it as PLY"},
    {{"nrrd", "nhdr", "mha", "mhd", "dcm"},
     "NRRD",
     "an image of voxels",
     "extract the boundary of its label, for example with skimage.measure.marching_cubes, and save it as PLY"},
    {{"x3d"}, "", "an X3D scene", "convert it to VRML 2.0 (.wrl), OBJ or PLY"},
    {{"ac"}, "AC3D", "an AC3D model", "convert it to OBJ or PLY"},
    {{"ase"}, "", "a 3ds Max ASCII export", "export OBJ or FBX instead"},
    {{"x"}, "", "a DirectX mesh", "convert it to OBJ or PLY"},
    {{"lwo", "lws"}, "", "a LightWave object", "convert it to OBJ or PLY"},
    {{"cob", "q3o", "q3s", "nff", "b3d"}, "", "a model of a 3-D editor", "convert it to OBJ or PLY"},
    {{"iqm", "md2", "md3", "md5mesh", "ms3d", "mdl"},
     "",
     "a model of a game",
     "convert it to OBJ or PLY, in the pose that counts"},
    {{"gts"}, "", "a GTS surface", "convert it with gts2stl"},
    {{"usd", "usda", "usdc", "usdz"}, "", "a USD scene", "export it as glTF, OBJ or PLY"},
    {{"pvtu", "pvtp", "vtm", "vti", "vtr", "vts"},
     "",
     "a data set of VTK that is not a single surface",
     "extract its surface in ParaView, and save it as .vtp"},
    {{"h5", "hdf5"},
     "\x89HDF\r\n",
     "an HDF5 file",
     "write its points or triangles as .xyz or PLY, for example with h5py"},
    {{"npy", "npz"}, "\x93NUMPY", "an array of NumPy", "save its points with numpy.savetxt as .xyz"},
    {{"mat"}, "MATLAB 5.0", "a file of MATLAB", "save its points with writematrix as .csv"},
    {{"xls", "xlsx", "ods"}, "\xd0\xcf\x11\xe0", "a spreadsheet", "save it as CSV, with decimal points"},
    {{"ptx"}, "", "a PTX scan, with a matrix for each scan", "convert it to .ply or .xyz with CloudCompare"},
    {{"pdf"}, "%PDF", "a PDF document", "name a mesh or points"},
    {{}, "version https://git-lfs", "a Git LFS pointer", "run `git lfs pull`, which fetches the file itself"},
    {{}, "<!DOCTYPE html", "a web page", "download the file itself"},
    {{}, "<html", "a web page", "download the file itself"},
    {{}, "ncols", "an ESRI grid of heights", "convert it to points, with gdal_translate -of XYZ"},
    {{"png"}, "\x89PNG", "a picture", "name a mesh or points"},
    {{"jpg", "jpeg"}, "\xff\xd8\xff", "a picture", "name a mesh or points"},
    {{"tif", "tiff", "bmp", "gif"}, "", "a picture", "name a mesh or points"},
    {{"zip"}, "PK\x03\x04", "a ZIP archive", "unpack it, and name a file in it"},
    {{"7z"}, "7z\xbc\xaf", "a 7z archive", "unpack it, and name a file in it"},
    {{"tar", "tgz", "bz2", "xz", "zst", "rar"}, "", "an archive", "unpack it, and name a file in it"},
    {{"blend"}, "BLENDER", "a Blender scene", "export it from Blender as PLY, OBJ or STL"},
};

}  // namespace

const std::vector<Format>& formats() { return table; }
const std::vector<Unread>& unread_formats() { return unread; }

const Format* find_format(std::string_view ending) {
    for (const Format& format : formats())
        if (std::find(format.endings.begin(), format.endings.end(), ending) != format.endings.end()) return &format;
    return nullptr;
}

std::string known_endings() {
    std::string text;
    for (const Format& format : formats()) {
        for (const std::string_view ending : format.endings) text += (text.empty() ? "." : ", .") + std::string(ending);
    }
    return text;
}

}  // namespace hausbench
