#include "datasets/hdf5.h"

#include "algorithms/printable.h"
#include "datasets/hash.h"
#include "datasets/seal.h"
#include "process/whole_file.h"

// Headers one by one, because the library's <hdf5.h> has the same name as our own header.
#include <H5public.h>

#include <H5Apublic.h>
#include <H5Dpublic.h>
#include <H5Epublic.h>
#include <H5FDcore.h>
#include <H5Fpublic.h>
#include <H5Gpublic.h>
#include <H5Ipublic.h>
#include <H5Lpublic.h>
#include <H5Opublic.h>
#include <H5Ppublic.h>
#include <H5Spublic.h>
#include <H5Tpublic.h>

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <type_traits>
#include <utility>

namespace hausbench::h5 {
namespace {

static_assert(std::is_same_v<hid_t, std::int64_t>, "File::id_ holds an hid_t");

// Returns why the last call of the library failed: the innermost message of its error stack, which is the most
// specific.
std::string library_message() {
    std::string text;
    const auto visit = [](unsigned, const H5E_error2_t* error, void* data) -> herr_t {
        auto& message = *static_cast<std::string*>(data);
        if (message.empty() && error->desc) message = error->desc;
        return 0;
    };
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, visit, &text);
    H5Eclear2(H5E_DEFAULT);
    return text.empty() ? "HDF5 gave no reason" : printable(text);  // the text may quote bytes of the file
}

// The file, or the object in it, that an operation works on; error messages begin with it.
struct Place {
    const std::filesystem::path& file;
    std::string object = "";

    [[noreturn]] void fail(const std::string& why) const {
        throw std::runtime_error(file.string() + ": " + (object.empty() ? "" : object + ": ") + why);
    }
    template <class T> T check(T status) const {
        if (status < 0) fail(library_message());
        return status;
    }
};

// An HDF5 identifier, closed at the end of its scope.
class Id {
public:
    Id(const Place& at, hid_t id, herr_t (*close)(hid_t)) : id_(at.check(id)), close_(close) {}
    ~Id() {
        if (id_ >= 0) close_(id_);
    }
    Id(Id&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
    Id(const Id&) = delete;
    Id& operator=(const Id&) = delete;
    operator hid_t() const { return id_; }  // NOLINT(google-explicit-constructor): C wants one

private:
    hid_t id_;
    herr_t (*close_)(hid_t);
};

template <class T> hid_t native() {
    if constexpr (std::is_same_v<T, double>) return H5T_NATIVE_DOUBLE;
    if constexpr (std::is_same_v<T, std::int64_t>) return H5T_NATIVE_INT64;
    if constexpr (std::is_same_v<T, std::uint64_t>) return H5T_NATIVE_UINT64;
    if constexpr (std::is_same_v<T, std::int32_t>) return H5T_NATIVE_INT32;
}

Id text_type(const Place& at) {
    Id type(at, H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type, H5T_VARIABLE);
    H5Tset_cset(type, H5T_CSET_UTF8);
    return type;
}

// Returns a property list with which new links also create missing groups.
Id links_with_groups(const Place& at) {
    Id links(at, H5Pcreate(H5P_LINK_CREATE), H5Pclose);
    at.check(H5Pset_create_intermediate_group(links, 1));
    return links;
}

void write_dataset(hid_t file, const Place& at, hid_t type, const void* values, std::size_t count,
                   std::size_t columns) {
    if (columns == 0 || count % columns != 0) throw std::logic_error(at.object + ": the last row is incomplete");
    const hsize_t extent[2] = {count / columns, columns};
    const Id space(at, H5Screate_simple(columns > 1 ? 2 : 1, extent, nullptr), H5Sclose);
    const Id creation(at, H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    at.check(H5Pset_obj_track_times(creation, 0));  // no times, so that the same contents give the same bytes
    const Id dataset(at, H5Dcreate2(file, at.object.c_str(), type, space, links_with_groups(at), creation, H5P_DEFAULT),
                     H5Dclose);
    if (count > 0) at.check(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values));
}

std::string group_name(const std::string& group) { return group.empty() ? "/" : group; }

std::string attribute_name(const std::string& group, const std::string& name) { return group_name(group) + "@" + name; }

// Returns whether a path exists. Checks its parents one by one, because H5Lexists fails if a parent does not exist.
bool exists(hid_t file, const std::string& name) {
    if (name.empty() || name == "/") return true;
    for (std::size_t slash = name.find('/', 1);; slash = name.find('/', slash + 1)) {
        if (H5Lexists(file, name.substr(0, slash).c_str(), H5P_DEFAULT) <= 0) return false;
        if (slash == std::string::npos) return true;
    }
}

// Returns the file that contains an object.
std::string file_of(hid_t object) {
    const ssize_t length = H5Fget_name(object, nullptr, 0);
    if (length <= 0) return "";
    std::string name(static_cast<std::size_t>(length) + 1, '\0');
    H5Fget_name(object, name.data(), name.size());
    return name;
}

// Throws if an object is in another file: a link may lead there.
void expect_in(hid_t file, hid_t object, const Place& at) {
    if (file_of(object) != file_of(file)) at.fail("is in another file, which is not read");
}

Id open_group(hid_t file, const Place& at, const std::string& group) {
    Id opened(at, H5Gopen2(file, group_name(group).c_str(), H5P_DEFAULT), H5Gclose);
    expect_in(file, opened, at);
    return opened;
}

void write_attribute(hid_t file, const Place& at, const std::string& group, const std::string& name, hid_t type,
                     const void* value) {
    if (!exists(file, group)) {
        const Id made(at, H5Gcreate2(file, group.c_str(), links_with_groups(at), H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
    }
    const Id opened = open_group(file, at, group);
    if (H5Aexists(opened, name.c_str()) > 0) at.check(H5Adelete(opened, name.c_str()));
    const Id space(at, H5Screate(H5S_SCALAR), H5Sclose);
    const Id attribute(at, H5Acreate2(opened, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    at.check(H5Awrite(attribute, type, value));
}

// The values of a dataset or an attribute. A damaged or malicious file may describe them wrongly, so only values that
// are stored in this file itself are read, and only if the file is large enough to contain as many as it claims.
class Values {
public:
    static Values of_dataset(hid_t file, const Place& at) {
        Id dataset(at, H5Dopen2(file, at.object.c_str(), H5P_DEFAULT), H5Dclose);
        expect_in(file, dataset, at);
        Id type(at, H5Dget_type(dataset), H5Tclose);
        return Values(at, std::move(dataset), std::move(type), false);
    }
    static Values of_attribute(hid_t owner, const Place& at, const std::string& name) {
        Id attribute(at, H5Aopen(owner, name.c_str(), H5P_DEFAULT), H5Aclose);
        Id type(at, H5Aget_type(attribute), H5Tclose);
        return Values(at, std::move(attribute), std::move(type), true);
    }

    std::vector<double> reals() const {
        expect_numbers(H5T_FLOAT, "real numbers");
        return raw<double>(native<double>());
    }

    template <class T> std::vector<T> integers() const {
        expect_numbers(H5T_INTEGER, attribute_ ? "an integer" : "integers");
        if (H5Tequal(type_, native<T>()) > 0) return raw<T>(native<T>());
        return H5Tget_sign(type_) == H5T_SGN_NONE ? narrowed<T, std::uint64_t>() : narrowed<T, std::int64_t>();
    }

    std::vector<std::string> texts() const {
        if (H5Tget_class(type_) != H5T_STRING) at_.fail(attribute_ ? "does not hold a text" : "does not hold texts");
        if (H5Tis_variable_str(type_) <= 0) at_.fail("holds texts of fixed length, which are not read");
        std::vector<std::string> values;
        std::size_t bytes = 0;
        for (char* text : raw<char*>(type_)) {
            values.emplace_back(text ? text : "");
            bytes += values.back().size();
            H5free_memory(text);
        }
        if (bytes > std::filesystem::file_size(at_.file))
            at_.fail("has texts that share their bytes, which is not read");
        return values;
    }

    // Reads values of any type that a result or a shape may have, and returns how many bytes they take.
    std::size_t bytes() const {
        switch (H5Tget_class(type_)) {
            case H5T_STRING: {
                std::size_t bytes = 0;
                for (const std::string& text : texts()) bytes += sizeof(std::string) + text.size();
                return bytes;
            }
            case H5T_FLOAT:
                return sizeof(double) * reals().size();
            case H5T_INTEGER:
                expect_numbers(H5T_INTEGER, "integers");
                return sizeof(std::uint64_t) * raw<std::uint64_t>(native<std::uint64_t>()).size();
            default:
                at_.fail("holds neither texts nor numbers");
        }
    }

private:
    Values(const Place& at, Id object, Id type, bool attribute)
        : at_(at), object_(std::move(object)), type_(std::move(type)), attribute_(attribute) {}

    void expect_numbers(H5T_class_t wanted, const char* words) const {
        if (H5Tget_class(type_) != wanted) at_.fail(std::string("does not hold ") + words);
        if (H5Tget_size(type_) > sizeof(double)) at_.fail("holds numbers of more than 64 bits, which are not read");
    }

    template <class T> std::vector<T> raw(hid_t as) const {
        std::vector<T> values(attribute_ ? scalar_count() : count());
        if (attribute_)
            at_.check(H5Aread(object_, as, values.data()));
        else if (!values.empty())
            at_.check(H5Dread(object_, as, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()));
        return values;
    }

    // Reads values as the type Wide, of 64 bits, and checks that they fit T. The library itself would clamp values that
    // do not fit, without an error.
    template <class T, class Wide> std::vector<T> narrowed() const {
        std::vector<T> values;
        for (const Wide value : raw<Wide>(native<Wide>())) {
            if (!std::in_range<T>(value)) at_.fail("holds " + std::to_string(value) + ", which is out of range");
            values.push_back(static_cast<T>(value));
        }
        return values;
    }

    // Returns 1 if an attribute has one value, otherwise throws: H5Aread would write more values past the end of the
    // buffer.
    std::size_t scalar_count() const {
        const Id space(at_, H5Aget_space(object_), H5Sclose);
        if (H5Sget_simple_extent_type(space) == H5S_NULL || H5Sget_simple_extent_npoints(space) != 1)
            at_.fail("is not one value");
        return 1;
    }

    std::size_t count() const {
        const Id space(at_, H5Dget_space(object_), H5Sclose);
        const int rank = at_.check(H5Sget_simple_extent_ndims(space));
        if (H5Sget_simple_extent_type(space) != H5S_SIMPLE || rank < 1 || rank > 2)
            at_.fail("is neither a column nor a table");
        const Id creation(at_, H5Dget_create_plist(object_), H5Pclose);
        const H5D_layout_t layout = H5Pget_layout(creation);
        if (layout != H5D_CONTIGUOUS && layout != H5D_CHUNKED && layout != H5D_COMPACT)
            at_.fail("is a view of other datasets, which is not read");
        if (H5Pget_external_count(creation) != 0) at_.fail("is kept in another file, which is not read");
        constexpr std::size_t most_bytes_of_one = 1032;  // of a stored byte, by deflate, the strongest filter
        const auto values = static_cast<std::size_t>(at_.check(H5Sget_simple_extent_npoints(space)));
        const std::size_t stored = H5Dget_storage_size(object_);
        if (stored > std::filesystem::file_size(at_.file)) at_.fail("is larger than its file");
        if (values > stored * most_bytes_of_one / H5Tget_size(type_))
            at_.fail("has " + std::to_string(values) + " values, more than are stored");
        return values;
    }

    Place at_;
    Id object_, type_;
    bool attribute_;
};

// The work of File::expect_self_contained().
class Walk {
public:
    explicit Walk(const std::filesystem::path& file)
        : file_(file), most_bytes_((std::size_t(256) << 20) + 16 * std::filesystem::file_size(file)) {}

    void group(hid_t file, const std::string& name, int depth) {
        const Place at{file_, name};
        const Id opened = open_group(file, at, name);
        attributes(opened, at);
        constexpr int deepest = 8;  // a group may contain itself
        if (depth > deepest) at.fail("is a group in too many groups");
        for (const Link& link : links(opened, at)) {
            const Place here{file_, name + (depth ? "/" : "") + link.name};
            if (link.type == H5L_TYPE_EXTERNAL) here.fail("is a link to another file, which is not read");
            if (link.type != H5L_TYPE_HARD) here.fail("is a link to another name, which is not read");
            const Id object(here, H5Oopen(opened, link.name.c_str(), H5P_DEFAULT), H5Oclose);
            const H5I_type_t type = H5Iget_type(object);
            if (type == H5I_GROUP) {
                group(file, here.object, depth + 1);
            } else if (type == H5I_DATASET) {
                attributes(object, here);
                add(Values::of_dataset(file, here), here);
            } else {
                here.fail("is neither a group nor a dataset");
            }
        }
    }

private:
    struct Link {
        std::string name;
        H5L_type_t type;
    };

    static std::vector<Link> links(hid_t group, const Place& at) {
        std::vector<Link> entries;
        const auto visit = [](hid_t, const char* name, const H5L_info_t* info, void* data) -> herr_t {
            static_cast<std::vector<Link>*>(data)->push_back({name, info->type});
            return 0;
        };
        at.check(H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, visit, &entries));
        return entries;
    }

    void attributes(hid_t object, const Place& at) {
        std::vector<std::string> names;
        const auto visit = [](hid_t, const char* name, const H5A_info_t*, void* data) -> herr_t {
            static_cast<std::vector<std::string>*>(data)->emplace_back(name);
            return 0;
        };
        at.check(H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, nullptr, visit, &names));
        for (const std::string& name : names) {
            const Place here{file_, attribute_name(at.object, name)};
            add(Values::of_attribute(object, here, name), here);
        }
    }

    void add(const Values& values, const Place& at) {
        bytes_ += values.bytes();
        if (bytes_ > most_bytes_) at.fail("takes much more memory than the size of its file justifies");
    }

    const std::filesystem::path& file_;
    std::size_t bytes_ = 0, most_bytes_;
};

}  // namespace

File::File(const std::filesystem::path& file, Open how) : path_(file), created_(how == Open::create) {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // prints no errors: they become exceptions
    H5Eclear2(H5E_DEFAULT);
    const Place at{path_};
    if (created_) {
        constexpr std::size_t growth = 1 << 20;  // bytes by which the file in memory grows at a time
        const Id access(at, H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
        at.check(H5Pset_fapl_core(access, growth, 0));
        id_ = H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
    } else {
        id_ = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    }
    at.check(id_);
}

File::~File() {
    if (id_ >= 0) H5Fclose(id_);
}

void File::close() {
    if (id_ < 0) return;
    if (created_) save();
    Place{path_}.check(H5Fclose(std::exchange(id_, -1)));
}

// Copies the bytes of the file from the library's memory and writes them to disk without the library. If HDF5 itself
// fails to write a file, it cannot close the file and crashes at exit.
void File::save() const {
    const Place at{path_};
    at.check(H5Fflush(id_, H5F_SCOPE_LOCAL));
    std::vector<char> image(std::size_t(at.check(H5Fget_file_image(id_, nullptr, 0))));
    at.check(H5Fget_file_image(id_, image.data(), image.size()));
    Sha256 hash;
    const std::string seal = seal_of(hash.add(image.data(), image.size()));
    image.insert(image.end(), seal.begin(), seal.end());
    const int created = create_afresh(path_);
    std::FILE* const out = created < 0 ? nullptr : ::fdopen(created, "wb");
    if (!out) at.fail(std::string("cannot be created: ") + std::strerror(errno));
    const bool written = std::fwrite(image.data(), 1, image.size(), out) == image.size() && std::fflush(out) == 0 &&
                         ::fsync(::fileno(out)) == 0;
    const int error = errno;
    if (std::fclose(out) != 0 || !written)
        at.fail(std::string("cannot be written: ") + std::strerror(written ? errno : error));
}

template <class T> void File::write(const std::string& name, const std::vector<T>& values, std::size_t columns) {
    write_dataset(id_, {path_, name}, native<T>(), values.data(), values.size(), columns);
}
template void File::write(const std::string&, const std::vector<double>&, std::size_t);
template void File::write(const std::string&, const std::vector<std::int64_t>&, std::size_t);
template void File::write(const std::string&, const std::vector<std::uint64_t>&, std::size_t);
template void File::write(const std::string&, const std::vector<std::int32_t>&, std::size_t);

void File::write(const std::string& name, const std::vector<std::string>& values) {
    std::vector<const char*> texts;
    for (const std::string& value : values) texts.push_back(value.c_str());
    const Place at{path_, name};
    write_dataset(id_, at, text_type(at), texts.data(), texts.size(), 1);
}

std::vector<double> File::read_doubles(const std::string& name) const {
    return Values::of_dataset(id_, {path_, name}).reals();
}
std::vector<std::int64_t> File::read_integers(const std::string& name) const {
    return Values::of_dataset(id_, {path_, name}).integers<std::int64_t>();
}
std::vector<std::uint64_t> File::read_unsigned(const std::string& name) const {
    return Values::of_dataset(id_, {path_, name}).integers<std::uint64_t>();
}
std::vector<std::int32_t> File::read_indices(const std::string& name) const {
    return Values::of_dataset(id_, {path_, name}).integers<std::int32_t>();
}
std::vector<std::string> File::read_texts(const std::string& name) const {
    return Values::of_dataset(id_, {path_, name}).texts();
}

void File::expect_self_contained() const { Walk(path_).group(id_, "/", 0); }

bool File::has(const std::string& name) const { return exists(id_, name); }

std::vector<std::string> File::children(const std::string& group) const {
    const Place at{path_, group};
    const Id opened = open_group(id_, at, group);
    std::vector<std::string> names;
    const auto visit = [](hid_t, const char* name, const H5L_info_t*, void* data) -> herr_t {
        static_cast<std::vector<std::string>*>(data)->emplace_back(name);
        return 0;
    };
    at.check(H5Literate(opened, H5_INDEX_NAME, H5_ITER_INC, nullptr, visit, &names));
    return names;
}

void File::attribute(const std::string& group, const std::string& name, const std::string& value) {
    const Place at{path_, attribute_name(group, name)};
    const char* text = value.c_str();
    write_attribute(id_, at, group, name, text_type(at), &text);
}

void File::attribute(const std::string& group, const std::string& name, std::int64_t value) {
    write_attribute(id_, {path_, attribute_name(group, name)}, group, name, native<std::int64_t>(), &value);
}

std::string File::text_attribute(const std::string& group, const std::string& name) const {
    const Place at{path_, attribute_name(group, name)};
    return Values::of_attribute(open_group(id_, at, group), at, name).texts().front();
}

std::int64_t File::integer_attribute(const std::string& group, const std::string& name) const {
    const Place at{path_, attribute_name(group, name)};
    return Values::of_attribute(open_group(id_, at, group), at, name).integers<std::int64_t>().front();
}

bool File::has_attribute(const std::string& group, const std::string& name) const {
    if (!exists(id_, group)) return false;
    return H5Aexists_by_name(id_, group_name(group).c_str(), name.c_str(), H5P_DEFAULT) > 0;
}

}  // namespace hausbench::h5
