#include "hdf5.h"

#include "hash.h"

// One by one, because the library's <hdf5.h> has the name of our own header.
#include <H5public.h>

#include <H5Apublic.h>
#include <H5Dpublic.h>
#include <H5Epublic.h>
#include <H5FDcore.h>
#include <H5Fpublic.h>
#include <H5Gpublic.h>
#include <H5Lpublic.h>
#include <H5Ppublic.h>
#include <H5Spublic.h>
#include <H5Tpublic.h>

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <type_traits>
#include <utility>

namespace hausbench::h5 {
namespace {

static_assert(std::is_same_v<hid_t, std::int64_t>, "File::id_ holds an hid_t");

// An HDF5 identifier, closed at the end of its scope.
class Id {
public:
    Id(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
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

// What went wrong first, in the library's own words.
std::string library_message() {
    std::string text;
    const auto visit = [](unsigned, const H5E_error2_t* error, void* data) -> herr_t {
        auto& message = *static_cast<std::string*>(data);
        if (message.empty() && error->desc) message = error->desc;
        return 0;
    };
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, visit, &text);
    H5Eclear2(H5E_DEFAULT);
    // Untrusted: it may hold line breaks, and quote the file. Control characters become question marks.
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c >= 0x7f; }, '?');
    return text.empty() ? "HDF5 gave no reason" : text;
}

constexpr std::string_view seal_mark = "\nsha256 ";
constexpr std::size_t seal_length = seal_mark.size() + 64 + 1;

std::string sealed(Sha256& hash) { return std::string(seal_mark) + hash.hex() + "\n"; }

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& object, const std::string& why) {
    throw std::runtime_error(file.string() + ": " + (object.empty() ? "" : object + ": ") + why);
}

template <class T> T check(T status, const std::filesystem::path& file, const std::string& object) {
    if (status < 0) fail(file, object, library_message());
    return status;
}

template <class T> hid_t native() {
    if constexpr (std::is_same_v<T, double>) return H5T_NATIVE_DOUBLE;
    if constexpr (std::is_same_v<T, std::int64_t>) return H5T_NATIVE_INT64;
    if constexpr (std::is_same_v<T, std::uint64_t>) return H5T_NATIVE_UINT64;
    if constexpr (std::is_same_v<T, std::int32_t>) return H5T_NATIVE_INT32;
}

Id text_type() {
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, H5T_VARIABLE);
    H5Tset_cset(type, H5T_CSET_UTF8);
    return Id(type, H5Tclose);
}

void write_dataset(hid_t file, const std::filesystem::path& path, const std::string& name, hid_t type,
                   const void* values, std::size_t count, std::size_t columns) {
    if (columns == 0 || count % columns != 0) throw std::logic_error(name + ": not a whole number of rows");
    const hsize_t extent[2] = {count / columns, columns};
    const Id space(check(H5Screate_simple(columns > 1 ? 2 : 1, extent, nullptr), path, name), H5Sclose);
    const Id links(check(H5Pcreate(H5P_LINK_CREATE), path, name), H5Pclose);
    check(H5Pset_create_intermediate_group(links, 1), path, name);
    const Id creation(check(H5Pcreate(H5P_DATASET_CREATE), path, name), H5Pclose);
    check(H5Pset_obj_track_times(creation, 0), path, name);  // the same contents, the same bytes
    const Id dataset(check(H5Dcreate2(file, name.c_str(), type, space, links, creation, H5P_DEFAULT), path, name),
                     H5Dclose);
    if (count > 0) check(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), path, name);
}

// The file that an object is in.
std::string file_of(hid_t object) {
    const ssize_t length = H5Fget_name(object, nullptr, 0);
    if (length <= 0) return "";
    std::string name(static_cast<std::size_t>(length) + 1, '\0');
    H5Fget_name(object, name.data(), name.size());
    return name;
}

// A link may lead into another file; what is there is not read.
void expect_in(hid_t file, hid_t object, const std::filesystem::path& path, const std::string& name) {
    if (file_of(object) != file_of(file)) fail(path, name, "is in another file, which is not read");
}

Id open_dataset(hid_t file, const std::filesystem::path& path, const std::string& name) {
    Id opened(check(H5Dopen2(file, name.c_str(), H5P_DEFAULT), path, name), H5Dclose);
    expect_in(file, opened, path, name);
    return opened;
}

// Deflate, the strongest filter of the library, makes at most 1032 bytes of one.
constexpr std::size_t most_bytes_of_one = 1032;

// What a file says of a dataset is not to be trusted: only values stored in this file itself, and no more of them than it has
// room for, are read.
std::size_t count_of(hid_t dataset, hid_t type, const std::filesystem::path& path, const std::string& name) {
    const Id space(check(H5Dget_space(dataset), path, name), H5Sclose);
    const int rank = check(H5Sget_simple_extent_ndims(space), path, name);
    if (H5Sget_simple_extent_type(space) != H5S_SIMPLE || rank < 1 || rank > 2)
        fail(path, name, "is neither a column nor a table");
    const Id creation(check(H5Dget_create_plist(dataset), path, name), H5Pclose);
    const H5D_layout_t layout = H5Pget_layout(creation);
    if (layout != H5D_CONTIGUOUS && layout != H5D_CHUNKED && layout != H5D_COMPACT)
        fail(path, name, "is a view of other datasets, which is not read");
    if (H5Pget_external_count(creation) != 0) fail(path, name, "is kept in another file, which is not read");
    const auto count = static_cast<std::size_t>(check(H5Sget_simple_extent_npoints(space), path, name));
    const std::size_t stored = H5Dget_storage_size(dataset);
    if (stored > std::filesystem::file_size(path)) fail(path, name, "is larger than its file");
    if (count > stored * most_bytes_of_one / H5Tget_size(type))
        fail(path, name, "has " + std::to_string(count) + " values, more than are stored");
    return count;
}

// An attribute is one value: reading more would write past it.
void expect_one_value(hid_t attribute, const std::filesystem::path& path, const std::string& object) {
    const Id space(check(H5Aget_space(attribute), path, object), H5Sclose);
    if (H5Sget_simple_extent_type(space) == H5S_NULL || H5Sget_simple_extent_npoints(space) != 1)
        fail(path, object, "is not one value");
}

// One of the types that are read: numbers of at most 64 bits, texts of any length.
void expect_type(hid_t type, H5T_class_t wanted, const char* words, const std::filesystem::path& path,
                 const std::string& name) {
    if (H5Tget_class(type) != wanted) fail(path, name, std::string("does not hold ") + words);
    if (wanted == H5T_STRING) {
        if (H5Tis_variable_str(type) <= 0) fail(path, name, "holds texts of fixed length, which are not read");
    } else if (H5Tget_size(type) > sizeof(double)) {
        fail(path, name, "holds numbers of more than 64 bits, which are not read");
    }
}

template <class T>
std::vector<T> read_raw(hid_t dataset, hid_t type, const std::filesystem::path& path, const std::string& name) {
    std::vector<T> values(count_of(dataset, type, path, name));
    if (!values.empty()) check(H5Dread(dataset, native<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), path, name);
    return values;
}

template <class T, class Wide> T narrowed(Wide value, const std::filesystem::path& path, const std::string& name) {
    if (!std::in_range<T>(value)) fail(path, name, "holds " + std::to_string(value) + ", which is out of range");
    return static_cast<T>(value);
}

// The library clamps values that do not fit and reports nothing, so the wider type is read first and checked.
template <class T, class Wide>
std::vector<T> read_checked(hid_t dataset, hid_t type, const std::filesystem::path& path, const std::string& name) {
    const std::vector<Wide> wide = read_raw<Wide>(dataset, type, path, name);
    std::vector<T> values;
    values.reserve(wide.size());
    for (const Wide value : wide) values.push_back(narrowed<T>(value, path, name));
    return values;
}

template <class T>
std::vector<T> read_any_integer(hid_t file, const std::filesystem::path& path, const std::string& name) {
    const Id dataset = open_dataset(file, path, name);
    const Id type(check(H5Dget_type(dataset), path, name), H5Tclose);
    expect_type(type, H5T_INTEGER, "integers", path, name);
    if (H5Tequal(type, native<T>()) > 0) return read_raw<T>(dataset, type, path, name);
    return H5Tget_sign(type) == H5T_SGN_NONE ? read_checked<T, std::uint64_t>(dataset, type, path, name)
                                             : read_checked<T, std::int64_t>(dataset, type, path, name);
}

std::string group_name(const std::string& group) { return group.empty() ? "/" : group; }

// H5Lexists wants every step of the path to exist.
bool exists(hid_t file, const std::string& name) {
    if (name.empty() || name == "/") return true;
    for (std::size_t slash = name.find('/', 1);; slash = name.find('/', slash + 1)) {
        if (H5Lexists(file, name.substr(0, slash).c_str(), H5P_DEFAULT) <= 0) return false;
        if (slash == std::string::npos) return true;
    }
}

Id open_group(hid_t file, const std::filesystem::path& path, const std::string& group) {
    Id opened(check(H5Gopen2(file, group_name(group).c_str(), H5P_DEFAULT), path, group), H5Gclose);
    expect_in(file, opened, path, group);
    return opened;
}

void write_attribute(hid_t file, const std::filesystem::path& path, const std::string& group, const std::string& name,
                     hid_t type, const void* value) {
    const std::string object = group_name(group) + "@" + name;
    if (!exists(file, group)) {
        const Id links(check(H5Pcreate(H5P_LINK_CREATE), path, object), H5Pclose);
        check(H5Pset_create_intermediate_group(links, 1), path, object);
        const Id made(check(H5Gcreate2(file, group.c_str(), links, H5P_DEFAULT, H5P_DEFAULT), path, object), H5Gclose);
    }
    const Id opened = open_group(file, path, group);
    if (H5Aexists(opened, name.c_str()) > 0) check(H5Adelete(opened, name.c_str()), path, object);
    const Id space(check(H5Screate(H5S_SCALAR), path, object), H5Sclose);
    const Id attribute(check(H5Acreate2(opened, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), path, object),
                       H5Aclose);
    check(H5Awrite(attribute, type, value), path, object);
}

}  // namespace

File::File(const std::filesystem::path& file, Open how) : path_(file), created_(how == Open::create) {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors become exceptions, nothing is printed
    H5Eclear2(H5E_DEFAULT);
    if (created_) {
        constexpr std::size_t growth = 1 << 20;  // bytes
        const Id access(check(H5Pcreate(H5P_FILE_ACCESS), path_, ""), H5Pclose);
        check(H5Pset_fapl_core(access, growth, 0), path_, "");
        id_ = H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
    } else {
        id_ = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    }
    if (id_ < 0) fail(path_, "", library_message());
}

File::~File() {
    if (id_ >= 0) H5Fclose(id_);
}

void File::close() {
    if (id_ < 0) return;
    if (created_) save();
    const hid_t id = id_;
    id_ = -1;
    check(H5Fclose(id), path_, "");
}

void check_seal(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary | std::ios::ate);
    const std::streamoff size = in.tellg();
    if (size < std::streamoff(seal_length)) return;
    std::string seal(seal_length, '\0');
    in.seekg(size - std::streamoff(seal_length));
    in.read(seal.data(), std::streamsize(seal_length));
    if (!seal.starts_with(seal_mark)) return;
    Sha256 hash;
    std::vector<char> buffer(1 << 18);
    in.seekg(0);
    for (std::streamoff left = size - std::streamoff(seal_length); left > 0 && in;) {
        in.read(buffer.data(), std::min<std::streamoff>(left, std::streamoff(buffer.size())));
        hash.add(buffer.data(), std::size_t(in.gcount()));
        left -= in.gcount();
    }
    if (seal != sealed(hash)) fail(file, "", "some of its bytes are not those that were written");
}

// The library cannot close a file that it could not write, and then crashes at exit: so the bytes are made in memory.
void File::save() const {
    check(H5Fflush(id_, H5F_SCOPE_LOCAL), path_, "");
    std::vector<char> image(std::size_t(check(H5Fget_file_image(id_, nullptr, 0), path_, "")));
    check(H5Fget_file_image(id_, image.data(), image.size()), path_, "");
    Sha256 hash;
    const std::string seal = sealed(hash.add(image.data(), image.size()));
    image.insert(image.end(), seal.begin(), seal.end());
    const int descriptor = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (descriptor < 0) fail(path_, "", std::string("cannot be created: ") + std::strerror(errno));
    std::size_t done = 0;
    int error = 0;
    while (done < image.size() && error == 0) {
        const ssize_t count = ::write(descriptor, image.data() + done, image.size() - done);
        if (count > 0)
            done += std::size_t(count);
        else if (errno != EINTR)
            error = errno;
    }
    if (error == 0 && ::fsync(descriptor) != 0) error = errno;
    if (::close(descriptor) != 0 && error == 0) error = errno;
    if (error != 0) fail(path_, "", std::string("cannot be written: ") + std::strerror(error));
}

void File::write(const std::string& name, const std::vector<double>& values, std::size_t columns) {
    write_dataset(id_, path_, name, H5T_NATIVE_DOUBLE, values.data(), values.size(), columns);
}
void File::write(const std::string& name, const std::vector<std::int64_t>& values, std::size_t columns) {
    write_dataset(id_, path_, name, H5T_NATIVE_INT64, values.data(), values.size(), columns);
}
void File::write(const std::string& name, const std::vector<std::uint64_t>& values, std::size_t columns) {
    write_dataset(id_, path_, name, H5T_NATIVE_UINT64, values.data(), values.size(), columns);
}
void File::write(const std::string& name, const std::vector<std::int32_t>& values, std::size_t columns) {
    write_dataset(id_, path_, name, H5T_NATIVE_INT32, values.data(), values.size(), columns);
}
void File::write(const std::string& name, const std::vector<std::string>& values) {
    std::vector<const char*> texts;
    texts.reserve(values.size());
    for (const std::string& value : values) texts.push_back(value.c_str());
    write_dataset(id_, path_, name, text_type(), texts.data(), texts.size(), 1);
}

std::vector<double> File::read_doubles(const std::string& name) const {
    const Id dataset = open_dataset(id_, path_, name);
    const Id type(check(H5Dget_type(dataset), path_, name), H5Tclose);
    expect_type(type, H5T_FLOAT, "real numbers", path_, name);
    return read_raw<double>(dataset, type, path_, name);
}

std::vector<std::int64_t> File::read_integers(const std::string& name) const {
    return read_any_integer<std::int64_t>(id_, path_, name);
}
std::vector<std::uint64_t> File::read_unsigned(const std::string& name) const {
    return read_any_integer<std::uint64_t>(id_, path_, name);
}
std::vector<std::int32_t> File::read_indices(const std::string& name) const {
    return read_any_integer<std::int32_t>(id_, path_, name);
}

std::vector<std::string> File::read_texts(const std::string& name) const {
    const Id dataset = open_dataset(id_, path_, name);
    const Id stored(check(H5Dget_type(dataset), path_, name), H5Tclose);
    expect_type(stored, H5T_STRING, "texts", path_, name);
    std::vector<char*> texts(count_of(dataset, stored, path_, name), nullptr);
    std::vector<std::string> values;
    if (texts.empty()) return values;
    check(H5Dread(dataset, stored, H5S_ALL, H5S_ALL, H5P_DEFAULT, texts.data()), path_, name);
    values.reserve(texts.size());
    for (const char* text : texts) values.emplace_back(text ? text : "");
    const Id space(check(H5Dget_space(dataset), path_, name), H5Sclose);
    H5Dvlen_reclaim(stored, space, H5P_DEFAULT, texts.data());
    return values;
}

bool File::has(const std::string& name) const { return exists(id_, name); }

std::vector<std::string> File::children(const std::string& group) const {
    const Id opened = open_group(id_, path_, group);
    std::vector<std::string> names;
    const auto visit = [](hid_t, const char* name, const H5L_info_t*, void* data) -> herr_t {
        static_cast<std::vector<std::string>*>(data)->emplace_back(name);
        return 0;
    };
    check(H5Literate(opened, H5_INDEX_NAME, H5_ITER_INC, nullptr, visit, &names), path_, group);
    return names;
}

void File::attribute(const std::string& group, const std::string& name, const std::string& value) {
    const char* text = value.c_str();
    write_attribute(id_, path_, group, name, text_type(), &text);
}

void File::attribute(const std::string& group, const std::string& name, std::int64_t value) {
    write_attribute(id_, path_, group, name, H5T_NATIVE_INT64, &value);
}

std::string File::text_attribute(const std::string& group, const std::string& name) const {
    const std::string object = group_name(group) + "@" + name;
    const Id opened = open_group(id_, path_, group);
    const Id attribute(check(H5Aopen(opened, name.c_str(), H5P_DEFAULT), path_, object), H5Aclose);
    const Id type(check(H5Aget_type(attribute), path_, object), H5Tclose);
    expect_type(type, H5T_STRING, "a text", path_, object);
    expect_one_value(attribute, path_, object);
    char* text = nullptr;
    check(H5Aread(attribute, type, &text), path_, object);
    const std::string value = text ? text : "";
    H5free_memory(text);
    return value;
}

std::int64_t File::integer_attribute(const std::string& group, const std::string& name) const {
    const std::string object = group_name(group) + "@" + name;
    const Id opened = open_group(id_, path_, group);
    const Id attribute(check(H5Aopen(opened, name.c_str(), H5P_DEFAULT), path_, object), H5Aclose);
    const Id type(check(H5Aget_type(attribute), path_, object), H5Tclose);
    expect_type(type, H5T_INTEGER, "an integer", path_, object);
    expect_one_value(attribute, path_, object);
    if (H5Tget_sign(type) == H5T_SGN_NONE) {
        std::uint64_t value = 0;
        check(H5Aread(attribute, H5T_NATIVE_UINT64, &value), path_, object);
        return narrowed<std::int64_t>(value, path_, object);
    }
    std::int64_t value = 0;
    check(H5Aread(attribute, H5T_NATIVE_INT64, &value), path_, object);
    return value;
}

bool File::has_attribute(const std::string& group, const std::string& name) const {
    if (!exists(id_, group)) return false;
    return H5Aexists_by_name(id_, group_name(group).c_str(), name.c_str(), H5P_DEFAULT) > 0;
}

}  // namespace hausbench::h5
