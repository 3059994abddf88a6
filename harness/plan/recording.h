// Reads recorded simulations: which moving objects overlap in each frame, and at which poses. docs/experiments.md
// describes the format.
#pragma once

#include "algorithms/kernel/geometry.h"

#include <filesystem>
#include <string>
#include <vector>

namespace hausbench {

struct Recording {
    // All overlaps of objects with the model `source` and objects with the model `target`, in the order of the frames.
    // A frame may occur several times, because several objects may have the same model.
    struct Pair {
        std::string source, target;
        std::vector<int> frames;
        std::vector<Pose> source_poses, target_poses;  // one for each entry of `frames`
    };

    int frames = 0;  // number of recorded frames, with or without overlaps
    std::vector<Pair> pairs;
};

// Reads a recording. Normalises the quaternions; the rotation matrices are accurate to a few units in the last place.
// Throws InputError with the number of the first wrong line.
Recording read_recording(const std::filesystem::path& file);

}  // namespace hausbench
