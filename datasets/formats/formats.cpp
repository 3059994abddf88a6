#include "datasets/formats/formats.h"

#include <algorithm>

namespace hausbench {
namespace readers {

// The readers of the table. Each is defined in a file of this folder.
Read read_obj, read_off, read_ply, read_stl, read_gltf, read_3mf, read_amf, read_collada, read_vrml, read_vtk,
    read_vtk_xml, read_medit, read_gmsh, read_dxf, read_3ds, read_pcd, read_xyz, read_csv;

}  // namespace readers

const std::vector<Format>& formats() {
    using namespace readers;
    static const std::vector<Format> all = {
        {{"obj"}, "Wavefront OBJ", read_obj, true, "", "", "", "", ""},
        {{"off"}, "OFF", read_off, true, "", "", "", "", ""},
        {{"ply"}, "PLY", read_ply, true, "", "", "", "", ""},
        {{"stl"}, "STL", read_stl, true, "", "", "", "", ""},
        {{"glb", "gltf"}, "glTF 2.0", read_gltf, true, "", "", "", "", ""},
        {{"3mf"}, "3MF", read_3mf, true, "", "", "", "", ""},
        {{"amf"}, "AMF", read_amf, true, "", "", "", "", ""},
        {{"dae"}, "Collada", read_collada, true, "", "", "", "", ""},
        {{"wrl", "vrml", "wrz"}, "VRML 2.0", read_vrml, true, "", "", "", "", ""},
        {{"vtk"}, "VTK legacy", read_vtk, true, "", "", "", "", ""},
        {{"vtp", "vtu"}, "VTK XML", read_vtk_xml, true, "", "", "", "", ""},
        {{"mesh", "meshb"}, "Medit", read_medit, true, "", "", "", "", ""},
        {{"msh"}, "Gmsh", read_gmsh, true, "", "", "", "", ""},
        {{"dxf"}, "DXF", read_dxf, true, "", "", "", "", ""},
        {{"3ds"}, "3D Studio", read_3ds, true, "", "", "", "", ""},
        {{"pcd"}, "Point Cloud Library", read_pcd, true, "", "", "", "", ""},
        {{"xyz", "pts", "txt", "asc", "xyzn", "xyzrgb"}, "points as text", read_xyz, true, "", "", "", "", ""},
        {{"csv"}, "points as a table", read_csv, true, "", "", "", "", ""},
        {{"ac", "ase", "fbx", "x3d"}, "through assimp", read_with_assimp, false, "", "", "", "", ""},
        {{"x", "lwo", "cob", "iqm", "md2", "ms3d", "nff", "q3o"},
         "through assimp",
         read_with_assimp,
         false,
         "",
         "",
         "",
         "",
         ""},
    };
    return all;
}

const std::vector<Unread>& unread_formats() {
    static const std::vector<Unread> all = {
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
        {{"png"}, "\x89PNG", "a picture", "name a mesh or points"},
        {{"jpg", "jpeg"}, "\xff\xd8\xff", "a picture", "name a mesh or points"},
        {{"tif", "tiff", "bmp", "gif"}, "", "a picture", "name a mesh or points"},
        {{"zip"}, "PK\x03\x04", "a ZIP archive", "unpack it, and name a file in it"},
        {{"7z"}, "7z\xbc\xaf", "a 7z archive", "unpack it, and name a file in it"},
        {{"tar", "tgz", "bz2", "xz", "zst", "rar"}, "", "an archive", "unpack it, and name a file in it"},
        {{"blend"}, "BLENDER", "a Blender scene", "export it from Blender as PLY, OBJ or STL"},
    };
    return all;
}

const Format* find_format(std::string_view ending) {
    for (const Format& one : formats())
        if (std::find(one.endings.begin(), one.endings.end(), ending) != one.endings.end()) return &one;
    return nullptr;
}

std::string known_endings(bool own_alone) {
    std::string text;
    for (const Format& one : formats()) {
        if (own_alone && !one.own) continue;
        for (const std::string_view ending : one.endings) text += (text.empty() ? "." : ", .") + std::string(ending);
    }
    return text;
}

}  // namespace hausbench
