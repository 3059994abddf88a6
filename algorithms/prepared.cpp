#include "prepared.h"

#include <chrono>
#include <stdexcept>
#include <utility>

namespace hausbench {

std::string to_string(const Need& need) {
    return (need.side == Side::source ? "source " : "target ") + need.structure.name;
}

const BuiltStructure& PreparedShape::structure(const StructureKind& kind) {
    if (const auto at = built_.find(kind.name); at != built_.end()) return at->second;
    if (!kind.fits(kind_of(shape_)))
        throw std::logic_error("a " + kind.name + " was declared, but the shape of that side is of another kind");
    const auto begin = std::chrono::steady_clock::now();
    BuiltStructure built = kind.build(shape_);
    built.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return built_.emplace(kind.name, std::move(built)).first->second;
}

Prepared::Prepared(const Scene& scene, const Needs& needs)
    : Prepared(std::make_shared<PreparedShape>(scene.source), std::make_shared<PreparedShape>(scene.target), needs) {}

Prepared::Prepared(std::shared_ptr<PreparedShape> source, std::shared_ptr<PreparedShape> target, const Needs& needs)
    : shapes_{std::move(source), std::move(target)} {
    for (const Need& need : needs) {
        const std::string name = to_string(need);
        if (declared_.contains(name)) continue;
        const BuiltStructure& built = shapes_[static_cast<std::size_t>(need.side)]->structure(need.structure);
        declared_[name] = built.object.get();
        times_.push_back({name, built.seconds, built.bytes});
    }
}

const void* Prepared::use(const std::string& name) const {
    const auto at = declared_.find(name);
    if (at == declared_.end()) throw std::logic_error("the " + name + " is used but was not declared in needs()");
    ++uses_[name];
    return at->second;
}

}  // namespace hausbench
