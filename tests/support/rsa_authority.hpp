// An authority as others make them. What includes this links OpenSSL::Crypto.
#pragma once

#include <openssl/evp.h>
#include <openssl/rsa.h>
#include <openssl/x509.h>

#include "common/certificate_issue.hpp"

namespace farhand {

// Of RSA-2048, with a certificate too long to be a side's.
inline Issued rsa_authority() {
  Issued out = make_authority("A test authority whose name is as long as a common name can be..");
  out.private_key = {EVP_RSA_gen(2048), EVP_PKEY_free};
  X509_set_pubkey(out.certificate.get(), out.private_key.get());
  X509_sign(out.certificate.get(), out.private_key.get(), EVP_sha256());
  return out;
}

}  // namespace farhand
