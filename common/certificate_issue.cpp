#include "common/certificate_issue.hpp"

#include <openssl/bio.h>
#include <openssl/crypto.h>
#include <openssl/ec.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/x509v3.h>

#include <array>
#include <stdexcept>
#include <vector>

#include "common/openssl_pointers.hpp"
#include "common/secret_file.hpp"

namespace farhand {
namespace {

void must(bool done) {
  if (!done)
    throw std::runtime_error(
        "OpenSSL makes no certificates of ECDSA over P-256: install an unrestricted libssl3");
}

std::shared_ptr<EVP_PKEY> new_private_key() {
  std::shared_ptr<EVP_PKEY> key(EVP_EC_gen("P-256"), EVP_PKEY_free);
  must(key != nullptr);
  return key;
}

// Positive and without a leading zero byte, so that none is shorter.
void set_serial(X509* x) {
  std::array<unsigned char, 16> bytes{};
  must(RAND_bytes(bytes.data(), bytes.size()) == 1);
  bytes[0] = static_cast<unsigned char>((bytes[0] & 0x3f) | 0x40);
  const std::unique_ptr<BIGNUM, Freed<BN_free>> number(
      BN_bin2bn(bytes.data(), bytes.size(), nullptr));
  must(number != nullptr && BN_to_ASN1_INTEGER(number.get(), X509_get_serialNumber(x)) != nullptr);
}

void extend(X509* x, X509* issuer, int what, const std::string& value) {
  X509V3_CTX context;
  X509V3_set_ctx(&context, issuer, x, nullptr, nullptr, 0);
  const std::unique_ptr<X509_EXTENSION, Freed<X509_EXTENSION_free>> extension(
      X509V3_EXT_conf_nid(nullptr, &context, what, value.c_str()));
  must(extension != nullptr && X509_add_ext(x, extension.get(), -1) == 1);
}

std::shared_ptr<X509> blank(const std::string& name, EVP_PKEY* key, const Lifetime& lifetime) {
  constexpr long kVersion3 = 2;
  std::shared_ptr<X509> x(X509_new(), X509_free);
  must(x != nullptr && X509_set_version(x.get(), kVersion3) == 1 &&
       X509_set_pubkey(x.get(), key) == 1 &&
       X509_NAME_add_entry_by_txt(X509_get_subject_name(x.get()), "CN", MBSTRING_UTF8,
                                  reinterpret_cast<const unsigned char*>(name.c_str()), -1, -1,
                                  0) == 1 &&
       X509_time_adj_ex(X509_getm_notBefore(x.get()), lifetime.from, 0, nullptr) != nullptr &&
       X509_time_adj_ex(X509_getm_notAfter(x.get()), lifetime.until, 0, nullptr) != nullptr);
  set_serial(x.get());
  return x;
}

void sign(X509* x, X509* issuer, EVP_PKEY* with) {
  must(X509_set_issuer_name(x, X509_get_subject_name(issuer)) == 1 &&
       X509_sign(x, with, EVP_sha256()) > 0);
}

template <typename Write>
std::string pem(Write write) {
  const std::unique_ptr<BIO, Freed<BIO_free>> bio(BIO_new(BIO_s_mem()));
  char* text = nullptr;
  must(bio != nullptr && write(bio.get()) == 1);
  const long size = BIO_get_mem_data(bio.get(), &text);
  return {text, static_cast<std::size_t>(size)};
}

struct NewFile {
  SecretFile file;
  std::string text;
  mode_t mode;
};

// No private key stays behind in memory.
struct NewFiles : std::vector<NewFile> {
  using std::vector<NewFile>::vector;
  ~NewFiles() {
    for (NewFile& f : *this) OPENSSL_cleanse(f.text.data(), f.text.size());
  }
};

// All or none.
void write_all(const NewFiles& files) {
  std::size_t made = 0;
  try {
    for (; made < files.size(); ++made)
      write_new_secret(files[made].file, files[made].text, files[made].mode);
  } catch (...) {
    std::error_code ignored;
    while (made > 0) std::filesystem::remove(files[--made].file.path, ignored);
    throw;
  }
}

void add(NewFiles& to, const std::filesystem::path& directory, const std::string& name,
         const Issued& of) {
  to.push_back(
      {{"private key file", directory / (name + "_key.pem")}, to_pem(*of.private_key), 0600});
  to.push_back({{"certificate file", directory / (name + ".pem")}, to_pem(*of.certificate), 0644});
}

}  // namespace

Issued make_authority(const std::string& name, const Lifetime& lifetime) {
  auto key = new_private_key();
  auto x = blank(name, key.get(), lifetime);
  extend(x.get(), x.get(), NID_basic_constraints, "critical,CA:TRUE,pathlen:0");
  extend(x.get(), x.get(), NID_key_usage, "critical,keyCertSign");
  extend(x.get(), x.get(), NID_subject_key_identifier, "hash");
  sign(x.get(), x.get(), key.get());
  return {std::move(x), std::move(key)};
}

Issued issue(const Issued& by, const Request& request) {
  auto key = new_private_key();
  X509* authority = by.certificate.get();
  auto x = blank(request.name, key.get(), request.lifetime);
  extend(x.get(), authority, NID_basic_constraints, "critical,CA:FALSE");
  extend(x.get(), authority, NID_key_usage, "critical,digitalSignature");
  extend(x.get(), authority, NID_subject_key_identifier, "hash");
  if (!request.usage.empty()) extend(x.get(), authority, NID_ext_key_usage, request.usage);
  extend(x.get(), authority, NID_authority_key_identifier, "keyid:always");
  sign(x.get(), authority, by.private_key.get());
  return {std::move(x), std::move(key)};
}

const char* usage_of(DtlsRole role) noexcept {
  return role == DtlsRole::client ? "clientAuth" : "serverAuth";
}

std::string observer_usage() {
  return std::string(usage_of(DtlsRole::client)) + "," + kObserverUsage;
}

std::string to_pem(x509_st& certificate) {
  return pem([&](BIO* to) { return PEM_write_bio_X509(to, &certificate); });
}

std::string to_pem(evp_pkey_st& private_key) {
  return pem([&](BIO* to) {
    return PEM_write_bio_PrivateKey(to, &private_key, nullptr, nullptr, 0, nullptr, nullptr);
  });
}

std::string write_new_certificates(const std::filesystem::path& directory, int days) {
  const Lifetime lifetime{.until = days};
  const Issued authority = make_authority("Farhand authority", lifetime);
  NewFiles files{
      {{"authority file", directory / "authority.pem"}, to_pem(*authority.certificate), 0644}};
  for (const auto& [name, usage] : {std::pair{"master", std::string(usage_of(DtlsRole::client))},
                                    {"slave", usage_of(DtlsRole::server)},
                                    {"observer", observer_usage()}})
    add(files, directory, name,
        issue(authority, {std::string("Farhand ") + name, usage, lifetime}));
  std::filesystem::create_directories(directory);
  for (const NewFile& f : files)
    if (std::filesystem::exists(f.file.path))
      refuse(f.file, "exists", "name a new directory; what is in use is never overwritten");
  write_all(files);
  return fingerprint(*authority.certificate);
}

}  // namespace farhand
