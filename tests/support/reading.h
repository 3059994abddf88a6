// A fixture for tests of file readers: writes a file, reads it, and checks its corners, its notes or its error.
#pragma once

#include "algorithms/error.h"
#include "datasets/load.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace hausbench {

class Reading : public ::testing::Test {
protected:
    // `name` is the file that the calls without a name write and read; its ending selects the format.
    explicit Reading(std::string name) : name_(std::move(name)) {}

    LoadedShape load(const std::string& bytes) const { return load(name_, bytes); }
    LoadedShape load(const std::string& name, const std::string& bytes, const LoadOptions& options = {}) const {
        const std::filesystem::path file = folder_.path() / name;
        std::ofstream(file, std::ios::binary) << bytes;
        return load_file(file, options);
    }

    // Returns the corners of all triangles of a mesh, three each. Throws for a point set.
    static std::vector<Vec3> corners(const LoadedShape& loaded) {
        const auto& mesh = std::get<TriangleMesh>(loaded.shape);
        std::vector<Vec3> all;
        for (const Index v : mesh.triangles.reshaped<Eigen::RowMajor>()) all.emplace_back(mesh.vertices.row(v));
        return all;
    }
    std::vector<Vec3> corners(const std::string& bytes) const { return corners(load(bytes)); }
    std::vector<Vec3> corners(const std::string& name, const std::string& bytes) const {
        return corners(load(name, bytes));
    }
    // Returns the points of a point set. Throws for a mesh.
    static std::vector<Vec3> rows(const LoadedShape& loaded) {
        const Points& points = std::get<PointSet>(loaded.shape).points;
        std::vector<Vec3> all;
        for (Index i = 0; i < points.rows(); ++i) all.emplace_back(points.row(i));
        return all;
    }

    // Expects as many points as in `where`, and no coordinate that differs by more than `off`. Shows `what` on failure.
    static void expect_near(const std::vector<Vec3>& points, const std::vector<Vec3>& where, double off,
                            const std::string& what = "") {
        ASSERT_EQ(points.size(), where.size()) << what;
        for (std::size_t i = 0; i < where.size(); ++i)
            EXPECT_LE((points[i] - where[i]).cwiseAbs().maxCoeff(), off)
                << what << ", corner " << i << ": " << points[i].transpose();
    }

    // Returns whether a note contains `part`.
    static bool has_note(const LoadedShape& loaded, const std::string& part) {
        return std::any_of(loaded.report.notes.begin(), loaded.report.notes.end(),
                           [&](const std::string& note) { return note.find(part) != std::string::npos; });
    }
    // Expects that a note is equal to `note`.
    static void expect_note(const LoadedShape& loaded, const std::string& note) {
        const std::vector<std::string>& notes = loaded.report.notes;
        EXPECT_TRUE(std::find(notes.begin(), notes.end(), note) != notes.end())
            << "no note '" << note << "' among " << ::testing::PrintToString(notes);
    }

    // Expects an InputError of one line that begins with the file's path and contains all `parts`.
    void refused(const std::string& bytes, const std::vector<std::string>& parts) const {
        refused(name_, bytes, parts);
    }
    void refused(const std::string& name, const std::string& bytes, const std::vector<std::string>& parts,
                 const LoadOptions& options = {}) const {
        try {
            load(name, bytes, options);
            FAIL() << name << " was read, without " << ::testing::PrintToString(parts) << ": " << bytes.substr(0, 300);
        } catch (const InputError& error) {
            const std::string message = error.what();
            EXPECT_TRUE(message.starts_with((folder_.path() / name).string() + ": ")) << message;
            EXPECT_EQ(message.find('\n'), std::string::npos) << message;
            for (const std::string& part : parts)
                EXPECT_NE(message.find(part), std::string::npos) << message << " lacks " << part;
        }
    }

    TemporaryFolder folder_;

private:
    std::string name_;
};

}  // namespace hausbench
