#include "harness/plan/recording.h"

#include "algorithms/error.h"
#include "harness/plan/motion.h"
#include "process/whole_file.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <utility>

namespace hausbench {
namespace {

// Returns the pose given by seven numbers: a unit quaternion, real part first, and a translation. Returns nothing if
// the length of the quaternion differs from 1 by more than 1e-6.
std::optional<Pose> pose_of(const double* numbers) {
    const Eigen::Quaterniond rotation(numbers[0], numbers[1], numbers[2], numbers[3]);
    if (std::abs(rotation.norm() - 1) > 1e-6) return std::nullopt;
    return Pose{rotation.normalized().toRotationMatrix(), Vec3(numbers[4], numbers[5], numbers[6])};
}

class Parser {
public:
    explicit Parser(const std::filesystem::path& file) : file_(file) {}

    Recording read() {
        expect_no_device(file_);
        std::ifstream in(file_);
        if (!in) throw InputError(fmt::format("{}: cannot open the recording: check its path", file_.string()));
        std::string line;
        while (std::getline(in, line)) {
            ++line_;
            if (const auto comment = line.find('#'); comment != std::string::npos) line.resize(comment);
            std::istringstream words(line);
            if (std::string kind; words >> kind) take(kind, words);
        }
        if (recording_.pairs.empty())
            fail("has no line 'pair': a recording without overlapping objects asks for nothing");
        return std::move(recording_);
    }

private:
    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(one_line(fmt::format("{}:{}: {}", file_.string(), line_, what)));
    }

    void take(const std::string& kind, std::istringstream& words) {
        if (kind == "hausbench" && !begun_) {
            std::string word, version, more;
            if (!(words >> word >> version) || word != "recording" || version != "1" || words >> more)
                fail("a recording begins with 'hausbench recording 1'");
            begun_ = true;
        } else if (!begun_) {
            fail("a recording begins with 'hausbench recording 1'");
        } else if (kind == "frames") {
            const auto count = finite_numbers(words, 1);
            if (!count || !((*count)[0] >= 1 && (*count)[0] <= 1e6) || std::trunc((*count)[0]) != (*count)[0])
                fail("'frames' is followed by how many there are");
            if (recording_.frames > 0) fail("'frames' is there twice");
            recording_.frames = int((*count)[0]);
        } else if (kind == "object") {
            int number = -1;
            std::string model, more;
            if (!(words >> number >> model) || words >> more || number < 0) fail("write 'object NUMBER MODEL'");
            if (!models_.emplace(number, model).second) fail(fmt::format("object {} is there twice", number));
        } else if (kind == "pair") {
            take_pair(words);
        } else {
            fail(fmt::format("unknown word '{}': a line begins with frames, object or pair", kind));
        }
    }

    void take_pair(std::istringstream& words) {
        constexpr const char* form =
            "write 'pair FRAME OBJECT OBJECT', then for each of the two a unit quaternion, its real part first, and a "
            "translation";
        const auto numbers = finite_numbers(words, 17);
        if (!numbers) fail(form);
        const auto whole = [&](std::size_t i) {
            if (!((*numbers)[i] >= 0 && (*numbers)[i] <= 1e6) || std::trunc((*numbers)[i]) != (*numbers)[i]) fail(form);
            return int((*numbers)[i]);
        };
        const int frame = whole(0), first = whole(1), second = whole(2);
        if (frame >= recording_.frames) fail(fmt::format("frame {} is not one of {}", frame, recording_.frames));
        if (frame < last_frame_) fail("frames go backwards: sort them");
        last_frame_ = frame;
        for (const int object : {first, second})
            if (!models_.contains(object)) fail(fmt::format("there is no object {}", object));
        if (first == second) fail("a pair needs two different objects");
        const auto a = pose_of(numbers->data() + 3), b = pose_of(numbers->data() + 10);
        if (!a || !b) fail("the length of a quaternion is not 1");
        const auto key = std::pair(models_.at(first), models_.at(second));
        const auto [at, fresh] = place_.emplace(key, recording_.pairs.size());
        if (fresh) recording_.pairs.push_back({key.first, key.second, {}, {}, {}});
        Recording::Pair& pair = recording_.pairs[at->second];
        pair.frames.push_back(frame);
        pair.source_poses.push_back(*a);
        pair.target_poses.push_back(*b);
    }

    const std::filesystem::path& file_;
    int line_ = 0, last_frame_ = 0;
    bool begun_ = false;
    std::map<int, std::string> models_;
    std::map<std::pair<std::string, std::string>, std::size_t> place_;
    Recording recording_;
};

}  // namespace

Recording read_recording(const std::filesystem::path& file) { return Parser(file).read(); }

}  // namespace hausbench
