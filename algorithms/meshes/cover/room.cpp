#include "algorithms/meshes/cover/room.h"

#include <utility>
#include <vector>

namespace hausbench {
namespace {

constexpr std::size_t most_spare_rooms = 4;

// Of this thread, given back and not in use.
std::vector<std::unique_ptr<CoverRoom::Covers>>& spare_rooms() {
    thread_local std::vector<std::unique_ptr<CoverRoom::Covers>> rooms;
    return rooms;
}

}  // namespace

CoverRoom::CoverRoom() {
    auto& spare = spare_rooms();
    if (spare.empty()) {
        covers_ = std::make_unique<Covers>();
        return;
    }
    covers_ = std::move(spare.back());
    spare.pop_back();
    // All else is set before it is read.
    covers_->rough.proof = covers_->exact.proof = nullptr;
    covers_->rough.distances = covers_->rough.tests = covers_->rough.cuts = 0;
    covers_->exact.distances = covers_->exact.tests = covers_->exact.cuts = 0;
}

CoverRoom::~CoverRoom() {
    if (!covers_ || spare_rooms().size() >= most_spare_rooms) return;
    covers_->rough.stack.clear();
    covers_->exact.stack.clear();
    spare_rooms().push_back(std::move(covers_));
}

}  // namespace hausbench
