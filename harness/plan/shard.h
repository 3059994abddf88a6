// Restricts a plan to one of n parts (shards), so that several machines can share the work: --shard i/n.
#pragma once

#include <string>
#include <vector>

namespace hausbench {

struct Plan;

struct Shard {  // --shard 2/3: the second of three
    int number = 1, of = 1;
    bool whole() const { return of == 1; }
};
std::string to_string(const Shard& shard);                           // "2/3"
inline constexpr const char* in_another_shard = "in another shard";  // the reason in rows of other shards

// Parses "i/n". Throws InputError unless 1 <= i <= n.
Shard parse_shard(const std::string& text);

// Removes the jobs of other shards from the plan. Their rows become `skipped` with the reason `in_another_shard`.
// `shards` holds the shard number of each job, from 1 (split.h). The jobs for reference answers go to the shards in
// turn.
void take_shard(Plan& plan, const Shard& shard, const std::vector<int>& shards);

}  // namespace hausbench
