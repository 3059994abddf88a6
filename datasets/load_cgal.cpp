#include "error.h"
#include "readers.h"

#include <CGAL/IO/OBJ.h>
#include <CGAL/IO/OFF.h>
#include <CGAL/IO/PLY.h>
#include <CGAL/IO/STL.h>
#include <CGAL/Simple_cartesian.h>
#include <fmt/format.h>

#include <new>
#include <sstream>

namespace hausbench::readers {
namespace {

// Reading only: CGAL's input and output package is LGPL, its mesh processing is GPL.
using Kernel = CGAL::Simple_cartesian<double>;
using CgalPoint = Kernel::Point_3;

// The first line that CGAL's reader rejects: coordinates that are not numbers, or an OFF face with an unknown
// vertex.
std::string first_bad_line(const Mended& mended, const std::string& format) {
    std::istringstream in(mended.bytes);
    std::string line;
    std::size_t vertex = 0, face = 0, corners = 0;
    const std::size_t skipped = format == "off" ? 2 : 0;
    for (std::size_t i = 0; std::getline(in, line) && i < mended.lines.size(); ++i) {
        if (i < skipped) continue;
        const auto at = [&](const std::string& why) {
            return fmt::format("line {}: {}: \"{}\"", mended.lines[i], why, line.substr(0, 80));
        };
        std::istringstream words(line);
        std::string keyword;
        if (format != "off") words >> keyword;
        if (keyword == "v" || keyword == "vertex" || (format == "off" && vertex < mended.points)) {
            double x = 0, y = 0, z = 0;
            if (!(words >> x >> y >> z))
                return at(fmt::format("vertex {} (from 0) does not have three finite coordinates", vertex));
            ++vertex;
            ++corners;
        } else if (format == "off") {
            long long count = -1, index = 0;
            words >> count;
            for (long long k = 0; k < count; ++k)
                if (!(words >> index) || index < 0 || static_cast<std::size_t>(index) >= mended.points)
                    return at(fmt::format("face {} (from 0) does not name {} of the {} vertices", face, count,
                                          mended.points));
            if (count < 0) return at(fmt::format("face {} (from 0) cannot be read", face));
            ++face;
        } else if (keyword == "facet") {
            corners = 0;
        } else if (keyword == "endfacet" && corners != 3) {
            return at(fmt::format("a facet of {} vertices ends here", corners));
        }
    }
    return "";
}

}  // namespace

Soup read_with_cgal(const std::string& name, std::string bytes, const std::string& format) {
    Mended mended = format == "obj"   ? mend_obj(name, std::move(bytes))
                    : format == "off" ? mend_off(name, bytes)
                    : format == "stl" ? mend_stl(name, std::move(bytes))
                                      : mend_ply(name, bytes);
    std::vector<CgalPoint> points;
    std::vector<std::vector<std::size_t>> faces;
    std::string trouble;
    bool read = false;
    try {
        std::istringstream in(mended.bytes);
        CGAL::IO::set_mode(in, format == "stl" || format == "ply" ? CGAL::IO::BINARY : CGAL::IO::ASCII);
        const auto quiet = CGAL::parameters::verbose(false);
        read = format == "obj"   ? CGAL::IO::read_OBJ(in, points, faces, quiet)
               : format == "off" ? CGAL::IO::read_OFF(in, points, faces, quiet)
               : format == "stl" ? CGAL::IO::read_STL(in, points, faces, quiet)
                                 : CGAL::IO::read_PLY(in, points, faces, quiet);
    } catch (const std::bad_alloc&) {
        throw InputError(name + ": announces more than fits into memory");
    } catch (const std::exception& error) {
        trouble = error.what();
    }
    // STL lists points by facet, so their number is not known beforehand. CGAL reads all lines of an OBJ file before it
    // fails; for a file without faces, or a number out of range, finish() gives a better message than CGAL.
    const bool complete = faces.size() == mended.faces && (format == "stl" || points.size() == mended.points);
    if (!complete || !(read || format == "obj") || !trouble.empty()) {
        std::string why = format == "ply" ? "" : first_bad_line(mended, format);
        if (why.empty() && format == "ply")
            why = fmt::format(
                "is truncated or damaged after {} of {} vertices and {} of {} faces (a coordinate that is no finite "
                "number ends the reading too)",
                points.size(), mended.points, faces.size(), mended.faces);
        if (why.empty())
            why = "cannot be read as " + format +
                  (trouble.empty() ? "" : " (" + trouble.substr(0, trouble.find('\n')) + ")");
        throw InputError(name + ": " + why);
    }
    Soup soup;
    soup.points.reserve(points.size());
    for (const CgalPoint& p : points) soup.points.emplace_back(p.x(), p.y(), p.z());
    soup.faces = std::move(faces);
    soup.objects = mended.objects;
    soup.float32 = mended.float32;
    soup.point_lines = std::move(mended.point_lines);
    soup.face_lines = std::move(mended.face_lines);
    return soup;
}

}  // namespace hausbench::readers
